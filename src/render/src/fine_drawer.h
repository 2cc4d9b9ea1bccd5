// SPDX-License-Identifier: Apache-2.0
/// \file fine_drawer.h  Thousands of fibres and blobs in a few calls: one small mesh each, one row of a buffer a piece.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <span>
#include <vector>

#include "shader_program.h"
#include "trocar/core/result.h"
#include "trocar/render/frame.h"

namespace trocar::render {

/// Needs the OpenGL context of the renderer that owns it.
class FineDrawer {
 public:
  FineDrawer() = default;
  FineDrawer(const FineDrawer&) = delete;
  FineDrawer& operator=(const FineDrawer&) = delete;
  ~FineDrawer();

  /// \return kShaderFailed with the compiler's words
  core::Status Make();

  /// Both programs, for the uniforms that the renderer sets once a frame.
  std::array<Program, 2> Programs() const { return {fibre_, blob_}; }

  /// \param X_camera_world  column-major
  /// \param pixel           size of one at a distance of 1 [-]
  /// \pre blending is on
  void DrawFibres(std::span<const Fibre> fibres, const Matrix4& X_camera_world, float pixel);
  void DrawBlobs(std::span<const Blob> blobs, const Matrix4& X_camera_world, float pixel);

 private:
  /// One row of the buffer that both share.
  struct Instance {
    std::array<float, 3> a{}, b{};
    std::array<float, 4> shape{};   // half width, wave, seed, emission
    std::array<float, 4> colour{};  // albedo, wetness
    float opacity = 1;
  };
  void MakeArray(GLuint& array, GLuint& places, std::span<const std::array<float, 3>> vertices);
  void Draw(const Program& program, GLuint array, GLenum mode, GLsizei vertices,
            const Matrix4& X_camera_world, float pixel);

  Program fibre_, blob_;
  GLuint instances_ = 0;
  GLuint fibre_array_ = 0, fibre_places_ = 0, blob_array_ = 0, blob_places_ = 0;
  GLsizei fibre_vertices_ = 0, blob_vertices_ = 0;
  std::vector<Instance> staging_;  // kept, so that a frame does not allocate
};

}  // namespace trocar::render
