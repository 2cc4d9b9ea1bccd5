// SPDX-License-Identifier: Apache-2.0
#include "trocar/instrument/trocar_kinematics.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::instrument {

using math::Vec3;

namespace {

/// Like std::clamp, but NaN becomes `low`.
double Clamp(double value, double low, double high) noexcept {
  return value > low ? std::min(value, high) : low;
}

}  // namespace

TrocarJoints ClampJoints(const TrocarJoints& joints, const JointLimits& limits) noexcept {
  return {Clamp(joints.pan, -limits.max_pan, limits.max_pan),
          Clamp(joints.tilt, -limits.max_tilt, limits.max_tilt),
          std::isfinite(joints.spin) ? joints.spin : 0.0,
          Clamp(joints.depth, limits.min_depth, limits.max_depth), Clamp(joints.jaw, 0.0, limits.max_jaw)};
}

math::Pose CalcToolPose(const Vec3& p_world_port, const TrocarJoints& joints) noexcept {
  const math::Quaternion rotation = math::RotationAbout({0, 1, 0}, joints.pan) *
                                    math::RotationAbout({1, 0, 0}, joints.tilt) *
                                    math::RotationAbout({0, 0, 1}, joints.spin);
  return {rotation, p_world_port + joints.depth * math::Rotate(rotation, {0, 0, -1})};
}

TrocarJoints FindJoints(const Vec3& p_world_port, const Vec3& p_world_tip, double spin, double jaw) noexcept {
  const Vec3 reach = p_world_tip - p_world_port;
  const double depth = math::Norm(reach);
  const Vec3 axis = math::Normalized(reach, {0, 0, -1});
  // axis = (-sin(pan) cos(tilt), sin(tilt), -cos(pan) cos(tilt))
  return {math::Atan2(-axis.x, -axis.z), math::Asin(std::clamp(axis.y, -1.0, 1.0)), spin, depth, jaw};
}

TrocarJoints LimitSpeed(const TrocarJoints& from, const TrocarJoints& to, double max_tip_speed,
                        double max_turn_rate, double dt) noexcept {
  const auto step = [](double a, double b, double most) { return a + std::clamp(b - a, -most, most); };
  // sideways the tip moves depth * angle
  const double lever = std::max({std::fabs(from.depth), std::fabs(to.depth), 0.01});
  const double most_angle = max_tip_speed * dt / lever;
  return {step(from.pan, to.pan, most_angle), step(from.tilt, to.tilt, most_angle),
          step(from.spin, to.spin, max_turn_rate * dt), step(from.depth, to.depth, max_tip_speed * dt),
          step(from.jaw, to.jaw, max_turn_rate * dt)};
}

}  // namespace trocar::instrument
