// SPDX-License-Identifier: Apache-2.0
/// \file tool_alignment.h  How a tool in its trocar stands before and around what it is to take.
#pragma once

#include <optional>

#include "trocar/agent/hand_motion.h"
#include "trocar/math/vector.h"

namespace trocar::agent {

/// Motion that a planner wants of a hand; what is not named stays as it is.
struct HandGoal {
  std::optional<math::Vec3> tip;    ///< world frame [m]
  double hurry = 1;                 ///< times the skill's speed
  std::optional<double> spin, jaw;  ///< [rad]
};
/// Sets the hand's goals; each tip goal begins a reach.
void BeginMotion(HandMotion& hand, const HandGoal& goal);

/// Point on the line from a trocar through `p`, `way` beyond `p`; before it where `way` is negative [m].
math::Vec3 PointBeyond(const math::Vec3& p_world_port, const math::Vec3& p, double way) noexcept;

/// Stand before a vessel with the jaws open across it.
/// \param along      unit, along the vessel at `p`
/// \param stand_off  from the tip to `p` [m], >= 0
/// \param jaw        opening [rad]
HandGoal LineUpAcross(const math::Vec3& p_world_port, const math::Vec3& p, const math::Vec3& along,
                      double stand_off, double jaw) noexcept;

/// Spin with which the tool's +y points as nearly as can be along `across`: FindSpin leaves open which way round [rad].
double FindUpperSpin(const math::Vec3& p_world_port, const math::Vec3& p_world_tip,
                     const math::Vec3& across) noexcept;

/// Unit vector along the toe of a hook whose tip is at a point.
math::Vec3 HookToe(const math::Vec3& p_world_port, const math::Vec3& p_world_tip, double spin) noexcept;
/// Where a hook's tip stands when the middle of its toe, which points along the unit vector `toe`, is at a point.
math::Vec3 HookTip(const math::Vec3& middle, const math::Vec3& toe) noexcept;

}  // namespace trocar::agent
