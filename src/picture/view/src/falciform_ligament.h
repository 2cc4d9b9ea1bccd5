// SPDX-License-Identifier: Apache-2.0
/// \file falciform_ligament.h  The fold of peritoneum from the liver's anterior face to the abdominal wall. Looks only.
#pragma once

#include <span>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::view {

/// A thin closed sheet with a free edge towards the feet, in which the round ligament runs.
///
/// \param attachment  where it leaves the liver, in any order; fewer than three give no sheet [m]
/// \param wall        about all of it, anterior is +z [m]
/// \return  the same bits for the same arguments
geometry::TriangleMesh MakeFalciformLigament(std::span<const math::Vec3> attachment,
                                             const geometry::TriangleMesh& wall);

}  // namespace trocar::view
