// SPDX-License-Identifier: Apache-2.0
/// \file geometry_drawer.h  Draws normals, depth, labels and motion into buffers of its own.
#pragma once

#include <epoxy/gl.h>

#include <optional>
#include <vector>

#include "shader_program.h"
#include "surface_store.h"
#include "trocar/base/result.h"
#include "trocar/math/pose.h"
#include "trocar/render/geometry_picture.h"

namespace trocar::render {

/// Needs the OpenGL context of the renderer that owns it.
class GeometryDrawer {
 public:
  GeometryDrawer() = default;
  GeometryDrawer(const GeometryDrawer&) = delete;
  GeometryDrawer& operator=(const GeometryDrawer&) = delete;
  ~GeometryDrawer();

  /// Binds the buffers, clears them, and sets what holds for the whole picture. Makes the program at the first call.
  /// \return kShaderFailed with the compiler's words; kNoGraphics where the driver has no such framebuffer
  base::Status Begin(const Matrix4& clip_from_camera, int width, int height, bool has_flow);
  /// \param X_earlier_surface  where it was before the lens of then; nothing where that is not known
  void Draw(const Surface& surface, const math::Pose& X_camera_surface, const math::Vec3& scale,
            std::uint16_t label, const std::optional<math::Pose>& X_earlier_surface);
  /// For vertices in the camera's frame that somebody else draws.
  const Program& BeginFine(std::uint16_t label);
  /// Copies the picture, first row at the top.
  void Read(GeometryPicture& picture, bool has_flow);

 private:
  base::Status Resize(int width, int height);

  Program program_;
  GLint label_place_ = -1;
  GLuint framebuffer_ = 0, normals_ = 0, labels_ = 0, flow_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<float> staging_;  // normal and depth of every pixel, or its flow
};

}  // namespace trocar::render
