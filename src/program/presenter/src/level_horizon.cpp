// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/level_horizon.h"

#include <algorithm>
#include <cmath>

namespace trocar::presenter {
namespace {

using math::Vec3;

/// Sine of the angle from straight down beyond which only the vertical counts [-].
constexpr double kSteep = 0.35;
/// Less than this is no direction [-].
constexpr double kNoDirection = 1e-6;

}  // namespace

math::Pose LevelHorizon(const math::Pose& X_world_camera) noexcept {
  const Vec3 view = math::Rotate(X_world_camera.rotation, {0, 0, -1});
  const double t = std::clamp(std::hypot(view.x, view.y) / kSteep, 0.0, 1.0);
  const double share = t * t * (3 - 2 * t);
  const Vec3 up = share * Vec3{0, 0, 1} + (1 - share) * Vec3{0, 1, 0};
  const Vec3 wanted = up - math::Dot(up, view) * view;
  if (!(math::Norm(wanted) > kNoDirection)) return X_world_camera;
  const Vec3 now = math::Rotate(X_world_camera.rotation, {0, 1, 0});
  const double roll = std::atan2(math::Dot(math::Cross(wanted, now), view), math::Dot(now, wanted));
  // about the camera's z, which points back along the view
  return {X_world_camera.rotation * math::RotationAbout({0, 0, 1}, roll), X_world_camera.translation};
}

}  // namespace trocar::presenter
