// SPDX-License-Identifier: Apache-2.0
/// \file jaws.h  Jaws of each kind, closed, in the tool frame: tips at the origin, hinge at z = jaw_length.
#pragma once

#include "trocar/geometry/triangle_mesh.h"
#include "trocar/instrument/tool.h"

namespace trocar::instrument {

/// \param side  +1 upper, -1 lower
/// \pre the tool has jaws (TROCAR_ASSERT)
geometry::TriangleMesh MakeJaw(const Tool& tool, int side);

/// Leg of the clip that a jaw holds: it ends at the jaw's tip; its root bends to the other leg.
geometry::TriangleMesh MakeClipLeg(const Tool& tool, int side);

}  // namespace trocar::instrument
