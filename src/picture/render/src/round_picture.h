// SPDX-License-Identifier: Apache-2.0
/// \file round_picture.h  The laparoscope's round edge, and a picture of the renderer's own whose edges it smooths.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <span>

#include "shader_program.h"
#include "trocar/base/result.h"
#include "trocar/render/frame.h"

namespace trocar::render {

/// Needs the OpenGL context of the renderer that owns it.
class RoundPicture {
 public:
  RoundPicture() = default;
  RoundPicture(const RoundPicture&) = delete;
  RoundPicture& operator=(const RoundPicture&) = delete;
  ~RoundPicture();

  /// \return kShaderFailed with the compiler's words
  base::Status Make();

  /// Draws black outside the circle at the near plane.
  void DrawMask(int width, int height);

  /// Makes the own framebuffer the target.
  /// \return false where the driver refuses it
  bool Bind(int width, int height);

  /// Copies the own picture into the bound framebuffer, which may be larger, with soft edges; outside the circle it is black.
  struct Smoothing {
    bool has_mask = true;
    bool has_glow = true;  ///< light that the lens scatters about highlights, too
    std::span<const Blot> blots;
  };
  void DrawSmoothed(const Smoothing& smoothing, int width, int height);

 private:
  void MakeRing();
  void MakeGlow(int width, int height);

  Program mask_, smooth_, smooth_fine_, smeared_, smeared_fine_, glow_;
  std::array<GLuint, 2> glow_framebuffers_{}, glow_pictures_{};
  int glow_width_ = 0, glow_height_ = 0;
  GLuint ring_ = 0, ring_vertices_ = 0;
  GLuint framebuffer_ = 0, picture_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;  // of the own picture
};

}  // namespace trocar::render
