// SPDX-License-Identifier: Apache-2.0
#include "view_planner.h"

#include "trocar/math/pose.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::agent {

using instrument::TrocarJoints;
using math::Pose;
using math::Vec3;

namespace {

constexpr double kTurnStep = 0.2;  // of the lens about the axis, to either side in turn [rad]
constexpr int kTurnSteps = 26;
constexpr double kTilts[] = {0.0, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75};  // of the lens along the axis [rad]
constexpr double kDistances[] = {0.060, 0.072, 0.050};                   // of the lens from the middle [m]
constexpr double kWorkDistances[] = {0.085, 0.072};                      // likewise while a tool is at it [m]
/// Between the line of sight and a shaft: more is not better, and less than the second is worth another look [rad].
constexpr double kWellPastShaft = 0.9, kPastShaft = 0.6;

/// Poses that show the field's middle from around its axis, those nearest to the trocar's own side first.
/// \param take  called with each and the lens's pose, until it returns true
template <class Take>
void TryViews(const ViewField& field, std::span<const double> distances, const Take& take) {
  const Vec3 to_eye = math::Normalized(field.setup->p_world_port - field.middle);
  const Vec3 across = math::Normalized(math::Cross(field.axis, to_eye), {1, 0, 0});
  for (int step = 0; step < kTurnSteps; ++step) {
    const double turn = (step % 2 == 0 ? 1 : -1) * kTurnStep * (1 + step / 2);
    for (const double tilt : kTilts) {
      const math::Quaternion turned =
          math::RotationAbout(field.axis, turn) * math::RotationAbout(across, tilt);
      for (const double distance : distances) {
        scene::ViewRequest request;
        request.p_world = field.middle;
        request.distance = distance;
        request.facing = math::Rotate(turned, to_eye);
        const auto found = scene::FindView(*field.setup, request);
        if (found && take(*found, scene::CalcLaparoscopePose(*field.setup, *found))) return;
      }
    }
  }
}

}  // namespace

std::optional<TrocarJoints> FindSideView(const ViewField& field,
                                         const std::function<double(const Vec3& eye)>& azimuth, int side,
                                         double aside) {
  std::optional<TrocarJoints> view;
  TryViews(field, kDistances, [&](const TrocarJoints& joints, const Pose& X_world_lens) {
    if (side * azimuth(X_world_lens.translation) < aside || !field.shows(X_world_lens)) return false;
    view = joints;
    return true;
  });
  return view;
}

std::optional<TrocarJoints> FindViewPastShaft(const ViewField& field, const Pose& now, const Vec3& shaft) {
  const auto angle_past_shaft = [&](const Pose& X_world_lens) {
    return math::AngleBetween(X_world_lens.translation - field.middle, shaft);
  };
  double best = field.shows(now) ? angle_past_shaft(now) : 0.0;
  if (best > kPastShaft) return std::nullopt;
  std::optional<TrocarJoints> view;
  TryViews(field, kWorkDistances, [&](const TrocarJoints& joints, const Pose& X_world_lens) {
    const double angle = angle_past_shaft(X_world_lens);
    if (angle <= best || !field.shows(X_world_lens)) return false;
    best = angle;
    view = joints;
    return best > kWellPastShaft;
  });
  return view;
}

}  // namespace trocar::agent
