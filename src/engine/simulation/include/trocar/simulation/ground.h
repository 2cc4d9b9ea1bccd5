// SPDX-License-Identifier: Apache-2.0
/// \file ground.h  Ground under the organs of a scene: the omentum.
#pragma once

#include <span>
#include <vector>

#include "trocar/geometry/omentum.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

/// Balls under which geometry::MakeOmentum leads the omentum: around all organs and tubes but the liver, which touches it.
/// \param surfaces   of Simulation::Surfaces()
/// \param positions  (nodes) of the first snapshot [m]
std::vector<geometry::Ball> FindOmentumBalls(std::span<const scene::SurfaceInfo> surfaces,
                                             std::span<const math::Vec3> positions);

}  // namespace trocar::simulation
