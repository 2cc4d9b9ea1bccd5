// SPDX-License-Identifier: Apache-2.0
#include "tool_alignment.h"

#include <cmath>

#include "trocar/instrument/tool.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::agent {

using math::Pose;
using math::Vec3;

void BeginMotion(HandMotion& hand, const HandGoal& goal) {
  if (goal.spin) hand.Turn(*goal.spin);
  if (goal.jaw) hand.SetJaw(*goal.jaw);
  if (goal.tip) hand.MoveTo(*goal.tip, goal.hurry);
}

Vec3 PointBeyond(const Vec3& p_world_port, const Vec3& p, double way) noexcept {
  return p + way * math::Normalized(p - p_world_port);
}

HandGoal LineUpAcross(const Vec3& p_world_port, const Vec3& p, const Vec3& along, double stand_off,
                      double jaw) noexcept {
  const Vec3 shaft = math::Normalized(p - p_world_port);
  HandGoal goal;
  goal.spin = FindSpin(p_world_port, p, math::Cross(shaft, along));
  goal.jaw = jaw;
  goal.tip = p - stand_off * shaft;
  return goal;
}

double FindUpperSpin(const Vec3& p_world_port, const Vec3& p_world_tip, const Vec3& across) noexcept {
  const double spin = FindSpin(p_world_port, p_world_tip, across);
  const Pose X =
      instrument::CalcToolPose(p_world_port, instrument::FindJoints(p_world_port, p_world_tip, spin, 0.0));
  return math::Dot(math::Rotate(X.rotation, {0, 1, 0}), across) < 0 ? spin + M_PI : spin;
}

Vec3 HookToe(const Vec3& p_world_port, const Vec3& p_world_tip, double spin) noexcept {
  return math::Rotate(
      instrument::CalcToolPose(p_world_port, instrument::FindJoints(p_world_port, p_world_tip, spin, 0.0))
          .rotation,
      {0, 1, 0});
}

Vec3 HookTip(const Vec3& middle, const Vec3& toe) noexcept {
  return middle - 0.5 * math::Distance(instrument::kHookToe.a, instrument::kHookToe.b) * toe;
}

}  // namespace trocar::agent
