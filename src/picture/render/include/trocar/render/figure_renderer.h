// SPDX-License-Identifier: Apache-2.0
/// \file figure_renderer.h  Draws a figure with OpenGL 3.3 core into whatever framebuffer is bound.
#pragma once

#include <memory>
#include <span>

#include "trocar/base/result.h"
#include "trocar/render/figure.h"

namespace trocar::render {

struct FigureOptions {
  SrgbColour background{0.075, 0.09, 0.105};
  bool has_axes = true;    ///< letters L, S, A (left, superior, anterior) in the lower left corner
  double pixel_scale = 1;  ///< framebuffer pixels a pixel of the marks' sizes, > 0
};

/// Surfaces and shaders in one OpenGL context, which must be current whenever a member is called and when the
/// renderer is destroyed.
class FigureRenderer {
 public:
  /// \pre an OpenGL context is current
  /// \return kGraphicsTooOld (below 3.3, or OpenGL ES) or kShaderFailed with the compiler's words
  static base::Result<FigureRenderer> Make();

  FigureRenderer(FigureRenderer&&) noexcept;
  FigureRenderer& operator=(FigureRenderer&&) noexcept;
  ~FigureRenderer();

  /// Takes the place of every earlier surface.
  /// \pre indices within the positions; one colour, or one a vertex (TROCAR_ASSERT)
  void SetSurfaces(std::span<const FigureSurface> surfaces);

  /// Draws into the bound framebuffer. Edges are smooth: it draws four samples a pixel where the driver has
  /// them. Leaves depth test, culling and blending off; leaves no program and no vertex array bound.
  /// \param width, height  of the framebuffer [pixels]; nothing happens when either is below 1
  /// \note The same figure gives the same pixels.
  void Draw(const OrbitCamera& camera, const FigureMarks& marks, const FigureOptions& options, int width,
            int height);

 private:
  struct Content;
  explicit FigureRenderer(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::render
