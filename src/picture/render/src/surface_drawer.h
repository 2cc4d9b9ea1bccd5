// SPDX-License-Identifier: Apache-2.0
/// \file surface_drawer.h  Draws surfaces with the shader of their material: tissue, tool, or what light passes through.
#pragma once

#include "noise_textures.h"
#include "shader_program.h"
#include "surface_store.h"
#include "trocar/base/result.h"
#include "trocar/math/pose.h"
#include "trocar/render/looks.h"

namespace trocar::render {

/// Needs the OpenGL context of the renderer that owns it.
class SurfaceDrawer {
 public:
  SurfaceDrawer() = default;
  SurfaceDrawer(const SurfaceDrawer&) = delete;
  SurfaceDrawer& operator=(const SurfaceDrawer&) = delete;
  ~SurfaceDrawer();

  /// \return kShaderFailed with the compiler's words
  base::Status Make(const Looks& looks);

  /// For the uniforms that the renderer sets once a frame.
  std::array<Program, 5> GetPrograms() const { return {tool_, plain_, clear_, tissue_[0], tissue_[1]}; }

  /// Before the first surface of a frame, after those uniforms; and after the last.
  /// \param tool_wear  of Frame
  /// \param is_coarse  coarse triangles where a surface has them
  void Begin(Quality quality, double tool_wear, bool is_coarse);
  static void End();

  /// \param scale  along the surface's own axes, before its pose [-]
  /// \pre blending is on where the look's opacity is below 1
  void Draw(const Surface& surface, const math::Pose& X_camera_surface, const math::Vec3& scale,
            const MaterialLook& look);

 private:
  const Program& Tissue() const { return tissue_[is_fine_ ? 1 : 0]; }
  const Program& FindProgram(const MaterialLook& look) const;

  std::array<Program, 2> tissue_;  // plain, fine
  Program tool_, plain_, clear_;
  bool is_fine_ = false, is_coarse_ = false;
  float tool_wear_ = 1;
  NoiseTextures noise_;
};

}  // namespace trocar::render
