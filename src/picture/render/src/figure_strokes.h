// SPDX-License-Identifier: Apache-2.0
/// \file figure_strokes.h  Lines, discs and letters of constant size in the picture, as triangles in clip
/// space.
#pragma once

#include <array>
#include <vector>

#include "trocar/render/figure.h"

namespace trocar::render {

/// A corner of a stroke's rectangle.
struct StrokeVertex {
  std::array<float, 4> clip;
  std::array<float, 3> colour;
  std::array<float, 3> local;  ///< x, y in [-1, 1]; z: 1 for a disc, 0 for a line
};

/// Triangles, three vertices each.
struct Strokes {
  std::vector<StrokeVertex> hidden;  ///< surfaces may hide them
  std::vector<StrokeVertex> on_top;
};

/// \param width, height  of the picture [pixels];
/// \param scale  its pixels a pixel of the marks' sizes
Strokes MakeStrokes(const FigureMarks& marks, const OrbitCamera& camera, int width, int height, double scale);

/// The body's axes as seen by the camera, with the letters L, S and A at their ends, in the lower left
/// corner.
std::vector<StrokeVertex> MakeAxes(const OrbitCamera& camera, int width, int height, double scale);

/// Distances in front of the lens between which everything is drawn [m].
struct DepthRange {
  double near = 0, far = 0;
};
DepthRange CalcDepthRange(const OrbitCamera& camera);

}  // namespace trocar::render
