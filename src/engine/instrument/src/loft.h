// SPDX-License-Identifier: Apache-2.0
/// \file loft.h  Solids between rings of points: what tools are made of.
#pragma once

#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::instrument {

/// Points of one cross-section, in order round it [m]. All rings of a solid have the same number.
using Ring = std::vector<math::Vec3>;

/// Closed solid through the rings, its ends covered; outward whichever way the rings run.
/// \pre at least two rings of at least three points (TROCAR_ASSERT)
geometry::TriangleMesh MakeLoft(const std::vector<Ring>& rings);

/// Closed solid through a loop of rings: as MakeLoft(), but without ends, the last ring joined to the first.
geometry::TriangleMesh MakeLoop(const std::vector<Ring>& rings);

/// Rectangle across the z axis with its corners cut, so that its edges catch the light.
Ring MakeBlockRing(double z, double x_low, double x_high, double y_low, double y_high);

/// Rectangle whose corners are round, from an ellipse (squareness 0) to nearly a rectangle (1).
Ring MakeRoundRing(double z, double half_width, double half_height, double squareness, int points);

/// Adds the triangles of `more` to `mesh`: one part of several solids.
void Append(geometry::TriangleMesh& mesh, const geometry::TriangleMesh& more);

}  // namespace trocar::instrument
