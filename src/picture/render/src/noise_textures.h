// SPDX-License-Identifier: Apache-2.0
/// \file noise_textures.h  The two noise tiles on the graphics card, from which tissue gets its pattern and bumps.
#pragma once

#include <epoxy/gl.h>

namespace trocar::render {

/// Needs the OpenGL context of the renderer that owns it.
class NoiseTextures {
 public:
  NoiseTextures() = default;
  NoiseTextures(const NoiseTextures&) = delete;
  NoiseTextures& operator=(const NoiseTextures&) = delete;
  ~NoiseTextures();

  void Make();

  /// The pattern becomes texture unit 0, the bumps unit 1; unit 0 is left active.
  void Bind() const;
  static void Unbind();

 private:
  GLuint pattern_ = 0, bumps_ = 0;
};

}  // namespace trocar::render
