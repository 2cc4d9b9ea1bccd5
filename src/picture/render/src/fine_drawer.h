// SPDX-License-Identifier: Apache-2.0
/// \file fine_drawer.h  Thousands of fibres and blobs in two calls: ribbons and domes that face the eye, in one buffer.
///
/// Their corners are worked out here and not by instances of a small mesh: where the processor draws, an instance costs
/// as much as many triangles.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shader_program.h"
#include "trocar/base/result.h"
#include "trocar/render/frame.h"
#include "trocar/render/looks.h"

namespace trocar::render {

/// How the picture lies to the camera.
struct Viewport {
  math::Pose X_camera_world;
  double focal = 0;                        ///< pixels at a distance of 1
  double half_width = 0, half_height = 0;  ///< of the picture [pixels]
};

/// Needs the OpenGL context of the renderer that owns it.
class FineDrawer {
 public:
  FineDrawer() = default;
  FineDrawer(const FineDrawer&) = delete;
  FineDrawer& operator=(const FineDrawer&) = delete;
  ~FineDrawer();

  /// \return kShaderFailed with the compiler's words
  base::Status Make(const Looks& looks);

  /// For the uniforms that the renderer sets once a frame.
  const Program& GetProgram() const { return program_; }

  /// \param program  in place of its own, with the same places of position and normal
  /// \pre blending is on, where the program is its own
  void DrawFibres(const Looks& looks, std::span<const Fibre> fibres, const Viewport& viewport,
                  const Program* program = nullptr);
  void DrawBlobs(const Looks& looks, std::span<const Blob> blobs, const Viewport& viewport,
                 const Program* program = nullptr);
  /// \pre blending is on
  void DrawPuffs(const Looks& looks, std::span<const Puff> puffs, const Viewport& viewport);

  /// Triangles of the last call.
  std::size_t TriangleCount() const { return indices_.size() / 3; }

 private:
  static constexpr std::size_t kMostSteps = 4;  // pieces of a fibre
  static constexpr std::size_t kShapes = 32;

  /// In the camera's frame.
  struct Corner {
    std::array<float, 3> position, normal;
    std::array<float, 4> albedo;   // and wetness
    std::array<float, 3> passing;  // emission, opacity, how open it lies
  };
  /// How far a fibre leaves its line at each step, along two directions across it, for a wave of 1.
  using Wave = std::array<std::array<float, 2>, kMostSteps + 1>;

  void Draw(const Program* program);

  Program program_;
  GLuint array_ = 0, corners_on_card_ = 0, indices_on_card_ = 0;
  std::array<Wave, kShapes> waves_{};
  std::vector<Corner> corners_;  // kept, so that a frame does not allocate
  std::vector<std::uint32_t> indices_;
};

}  // namespace trocar::render
