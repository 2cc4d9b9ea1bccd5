// SPDX-License-Identifier: Apache-2.0
/// \file pressed_tissue.h  Where tools press or pinch tissue: blood is pressed out of it, and it turns white.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/math/vector.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// A straight piece along which a tool presses.
struct Press {
  math::Vec3 a, b;      ///< ends, world frame [m]
  double strength = 0;  ///< of the whitening where it presses, 0 to 1 [-]
  std::int32_t surface =
      -1;  ///< of Simulation::Surfaces() that it presses: what lies behind keeps its colour
};

/// Of jaws by their pinch, of what only touches by its force; none where it is too weak to be seen.
std::vector<Press> FindPresses(const simulation::Snapshot& snapshot);

/// How white the tissue of a surface is at a place, 0 to 1 [-].
double CalcPressedPallor(std::span<const Press> presses, std::int32_t surface,
                         const math::Vec3& p_world) noexcept;

}  // namespace trocar::view
