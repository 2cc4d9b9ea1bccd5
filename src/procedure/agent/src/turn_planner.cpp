// SPDX-License-Identifier: Apache-2.0
#include "turn_planner.h"

#include "trocar/agent/hand_motion.h"
#include "trocar/math/pose.h"

namespace trocar::agent {

using math::Vec3;

namespace {

constexpr double kFolded = 0.7;  // a tube whose ends are nearer than that, in their distance at rest [-]

}  // namespace

HoldTurn TurnAside(const HoldPose& hold, const TurnAxis& tube, int side, double by, double turn,
                   const Vec3& fallback) noexcept {
  const Vec3 axis = math::Normalized(tube.organ_end - tube.far_end);
  const Vec3 arm = hold.tip - tube.organ_end;
  const Vec3 off_axis = math::Normalized(arm - math::Dot(arm, axis) * axis, fallback);
  return {-side * by * math::Cross(axis, off_axis), FindRoll(hold.port, hold.tip, axis, -side * turn)};
}

HoldTurn TakeRound(const HoldPose& hold, const TurnAxis& tube, const Vec3& at_rest, double angle) noexcept {
  const bool is_folded = math::Distance(tube.organ_end, tube.far_end) < kFolded * math::Norm(at_rest);
  const Vec3 out = is_folded ? tube.far_end + at_rest - tube.organ_end : Vec3{};
  const Vec3 axis = math::Normalized(tube.organ_end + out - tube.far_end);
  const Vec3 arm = hold.tip - tube.organ_end;
  return {out + math::Rotate(math::RotationAbout(axis, angle), arm) - arm,
          FindRoll(hold.port, hold.tip, axis, angle)};
}

}  // namespace trocar::agent
