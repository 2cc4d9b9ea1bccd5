// SPDX-License-Identifier: Apache-2.0
#include "camera_holder.h"

#include <algorithm>
#include <cmath>

#include "trocar/instrument/state_fields.h"
#include "trocar/math/elementary.h"

namespace trocar::simulation {

using math::Vec3;
using scene::CalcLaparoscopePose;
using scene::FindView;
using scene::ViewRequest;

namespace {

/// A tip farther out than this, of half of the picture, makes it move; it stops when all are within the second.
constexpr double kOuter = 0.7, kInner = 0.45;
constexpr double kNearest = 0.055, kFarthest = 0.125;  // of the tips from the lens [m]
/// How far beyond these a distance may be before it moves [m].
constexpr double kPlay = 0.015;
constexpr double kTurnRate = 0.35;    // [rad/s]
constexpr double kSlideRate = 0.04;   // [m/s]
constexpr double kLookSeconds = 0.1;  // between two thoughts on where to go
constexpr double kMostDepth = 0.28;   // of the lens [m]

/// Of a point in the picture, from its middle: 1 at the rim of the round field. Large behind the lens.
double CalcEccentricity(const math::Pose& X_world_lens, double field_of_view, const Vec3& p) noexcept {
  const Vec3 p_lens = math::Inverse(X_world_lens) * p;
  return math::Atan2(math::Hypot(p_lens.x, p_lens.y), -p_lens.z) / (0.5 * field_of_view);
}

}  // namespace

void CameraHolder::Reset(const instrument::TrocarJoints& at) noexcept {
  now_ = to_ = at;
  since_look_ = 0;
  is_moving_ = false;
}

const instrument::TrocarJoints& CameraHolder::Follow(const scene::LaparoscopeSetup& setup,
                                                     std::span<const Vec3> tips, double dt) noexcept {
  if (tips.empty()) return now_;
  Vec3 middle;
  for (const Vec3& tip : tips) middle += tip / static_cast<double>(tips.size());
  double apart = 0;  // of a tip from the middle [m]
  for (const Vec3& tip : tips) apart = std::max(apart, math::Distance(tip, middle));
  // far enough for both tips to lie within the inner zone
  const double wanted =
      std::clamp(apart / math::Tan(kInner * 0.5 * setup.field_of_view), kNearest, kFarthest);
  const math::Pose X = CalcLaparoscopePose(setup, now_);
  double outermost = 0;
  for (const Vec3& tip : tips) outermost = std::max(outermost, CalcEccentricity(X, setup.field_of_view, tip));
  const double distance = -(math::Inverse(X) * middle).z;
  is_moving_ = is_moving_ ? outermost > kInner || std::fabs(distance - wanted) > 0.3 * kPlay
                          : outermost > kOuter || std::fabs(distance - wanted) > kPlay;
  since_look_ += dt;
  if (is_moving_ && since_look_ >= kLookSeconds) {
    since_look_ = 0;
    // the light post stays: what turns about it turns the trainee's head
    ViewRequest request;
    request.p_world = middle;
    request.most_depth = kMostDepth;
    // as far away as the trocar allows
    for (request.distance = wanted; request.distance >= kNearest; request.distance *= 0.93) {
      const auto view = FindView(setup, request, now_.spin);
      if (!view) continue;
      to_ = *view;
      break;
    }
  }
  if (!is_moving_) return now_;
  const auto follow = [&](double& joint, double to, double rate) {
    joint += std::clamp(to - joint, -rate * dt, rate * dt);
  };
  follow(now_.pan, to_.pan, kTurnRate);
  follow(now_.tilt, to_.tilt, kTurnRate);
  follow(now_.depth, to_.depth, kSlideRate);
  return now_;
}

void CameraHolder::VisitState(base::StateArchive& archive) {
  archive.Field("now", now_);
  archive.Field("to", to_);
  archive.Field("since_look", since_look_);
  archive.Field("is_moving", is_moving_);
}

}  // namespace trocar::simulation
