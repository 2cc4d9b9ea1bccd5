// SPDX-License-Identifier: Apache-2.0
/// \file ground.h  What lies under the organs of a scene.
#pragma once

#include <span>
#include <vector>

#include "trocar/geometry/omentum.h"
#include "trocar/simulation/simulation.h"

namespace trocar::simulation {

using math::Vec3;

/// What the omentum passes under, for geometry::MakeOmentum: everything but the liver, which lies on it.
/// \param surfaces   of Simulation::Surfaces()
/// \param positions  (nodes) of the first snapshot [m]
std::vector<geometry::Ball> FindOmentumBalls(std::span<const SurfaceInfo> surfaces,
                                             std::span<const Vec3> positions);

}  // namespace trocar::simulation
