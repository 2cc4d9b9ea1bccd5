// SPDX-License-Identifier: Apache-2.0
/// \file turn_planner.h  Turning an organ about the tube that holds it, by the hand that holds the organ.
#pragma once

#include "trocar/math/vector.h"

namespace trocar::agent {

/// Where a hand holds what it turns.
struct HoldPose {
  math::Vec3 port, tip;  ///< [m]
};

/// The tube about which an organ turns.
struct TurnAxis {
  math::Vec3 organ_end, far_end;  ///< where it enters the organ, and its other end [m]
};

/// Motion of the hand that turns what it holds.
struct HoldTurn {
  math::Vec3 by;    ///< of the tip [m]
  double roll = 0;  ///< of the tool about its shaft [rad]
};

/// Draws what is held to one side about the tube.
/// \param side      from where the organ is to be seen, +1 or -1
/// \param by        [m], >= 0
/// \param turn      of the hold about the tube, as far as the tool can roll [rad], >= 0
/// \param fallback  unit vector, off the tube where the hand holds on its axis
HoldTurn TurnAside(const HoldPose& hold, const TurnAxis& axis, int side, double by, double turn,
                   const math::Vec3& fallback) noexcept;

/// Takes what is held round the tube, no farther from it, with the tool rolling along. A tube that has folded is drawn out as it
/// lay at rest.
/// \param at_rest  from the tube's far end to the organ's end, at rest [m]
/// \param angle    [rad]
HoldTurn TakeRound(const HoldPose& hold, const TurnAxis& axis, const math::Vec3& at_rest,
                   double angle) noexcept;

}  // namespace trocar::agent
