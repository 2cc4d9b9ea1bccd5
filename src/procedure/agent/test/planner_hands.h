// SPDX-License-Identifier: Apache-2.0
/// \file planner_hands.h  Hands of planners' tests: without tremor, one trocar each, 15 cm above a field at the origin.
#pragma once

#include "trocar/agent/hand_motion.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::agent {

inline constexpr double kTestTick = 1.0 / 120;  // [s]

/// A hand whose tip is at a point.
inline HandMotion HandAt(const math::Vec3& p_world_port, const math::Vec3& p_world_tip, double spin = 0) {
  HandSkill skill;
  skill.tremor = 0;
  return {p_world_port, instrument::FindJoints(p_world_port, p_world_tip, spin, 0.0), skill, 1};
}

/// Where its tool is after a tick.
inline math::Pose StepTool(HandMotion& hand) {
  return instrument::CalcToolPose(hand.Port(), hand.Step(kTestTick));
}

}  // namespace trocar::agent
