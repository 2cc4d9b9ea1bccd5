// SPDX-License-Identifier: Apache-2.0
/// \file cairo_drawing.h  A drawing on a Cairo surface: in a PDF, or in a window.
#pragma once

#include "trocar/report/drawing.h"

using cairo_t = struct _cairo;

namespace trocar::report {

/// Background of a drawing.
enum class Ground : std::uint8_t { kLight, kDark };

/// Draws every shape, one pixel of the drawing to one unit of the surface.
void PaintDrawing(cairo_t& cairo, const Drawing& drawing, Ground ground);

}  // namespace trocar::report
