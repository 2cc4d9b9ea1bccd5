// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/pointer_map.h"

#include <algorithm>
#include <cmath>

namespace trocar::presenter {
namespace {

using math::Vec3;

/// Joint rates are held finite near the singular poses: no lever shorter than this [m].
constexpr double kShortestLever = 0.01;
/// Nearer to the lens a line of sight says little [m].
constexpr double kNearestSight = 0.01;

}  // namespace

math::Vec3 CalcSightLine(const math::Pose& X_world_view, const math::Vec3& p_world) noexcept {
  const Vec3 p_view = math::Inverse(X_world_view) * p_world;
  // at the picture's rim or beside the lens the line would lead to the side
  if (!(p_view.z < -kNearestSight) || std::hypot(p_view.x, p_view.y) > -p_view.z) return {0, 0, -1};
  return math::Normalized(p_view);
}

device::PointerMap CalcPointerMap(const instrument::TrocarJoints& joints, const math::Pose& X_world_view,
                                  const math::Vec3& p_view_away) noexcept {
  const double cos_pan = std::cos(joints.pan), sin_pan = std::sin(joints.pan);
  const double cos_tilt = std::cos(joints.tilt), sin_tilt = std::sin(joints.tilt);
  // unit directions in which the tip goes when one joint grows
  const Vec3 along_pan{-cos_pan, 0.0, sin_pan};
  const Vec3 along_tilt{sin_pan * sin_tilt, cos_tilt, cos_pan * sin_tilt};
  const Vec3 along_depth{-sin_pan * cos_tilt, sin_tilt, -cos_pan * cos_tilt};
  const double pan_lever = std::max(joints.depth * cos_tilt, kShortestLever);
  const double tilt_lever = std::max(joints.depth, kShortestLever);
  const auto rates = [&](const Vec3& p_view) -> device::JointRates {
    const Vec3 way = math::Rotate(X_world_view.rotation, p_view);
    return {math::Dot(way, along_pan) / pan_lever, math::Dot(way, along_tilt) / tilt_lever,
            math::Dot(way, along_depth)};
  };
  return {rates({1, 0, 0}), rates({0, 1, 0}), rates(p_view_away)};
}

double CalcMetresPerPixel(const math::Pose& X_world_view, const Vec3& p_world_tip, double field_of_view,
                          double pixels) noexcept {
  const double distance = -(math::Inverse(X_world_view) * p_world_tip).z;
  const double metres = 2.0 * distance * std::tan(0.5 * field_of_view) / std::max(pixels, 1.0);
  return std::isfinite(metres) ? std::clamp(metres, 1e-5, 1e-3) : 1e-4;
}

}  // namespace trocar::presenter
