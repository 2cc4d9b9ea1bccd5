// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "trocar/scene/scene.h"

namespace trocar::scene {

using math::Vec3;

namespace {

constexpr int kSpins = 72;             // light posts that are tried
constexpr int kRounds = 40;            // of the fixed point for one
constexpr double kFound = 1e-4;        // how near the picture's middle comes to the point [m]
constexpr double kLeastDepth = 0.010;  // of the lens below the wall [m]

}  // namespace

math::Pose CalcLaparoscopePose(const LaparoscopeSetup& setup,
                               const instrument::TrocarJoints& joints) noexcept {
  instrument::TrocarJoints unspun = joints;
  unspun.spin = 0;
  const math::Pose X_world_shaft = instrument::CalcToolPose(setup.p_world_port, unspun);
  const math::Quaternion post = math::RotationAbout({0, 0, 1}, joints.spin);
  const math::Quaternion bend = math::RotationAbout({1, 0, 0}, setup.view_angle);
  return {X_world_shaft.rotation * (post * bend * math::Inverse(post)), X_world_shaft.translation};
}

std::optional<instrument::TrocarJoints> FindView(const LaparoscopeSetup& setup, const ViewRequest& request,
                                                 double spin) noexcept {
  instrument::TrocarJoints joints = instrument::FindJoints(setup.p_world_port, request.p_world, spin, 0.0);
  double miss = 1;
  for (int round = 0; round < kRounds && miss > kFound; ++round) {
    const math::Pose X = CalcLaparoscopePose(setup, joints);
    miss = math::Norm(math::Inverse(X) * request.p_world - Vec3{0, 0, -request.distance});
    const Vec3 lens = request.p_world - request.distance * math::Rotate(X.rotation, {0, 0, -1});
    joints = instrument::FindJoints(setup.p_world_port, lens, spin, 0.0);
  }
  if (miss > kFound || joints.depth < kLeastDepth || joints.depth > request.most_depth) return std::nullopt;
  return joints;
}

std::optional<instrument::TrocarJoints> FindView(const LaparoscopeSetup& setup,
                                                 const ViewRequest& request) noexcept {
  std::optional<instrument::TrocarJoints> best;
  double best_cost = 0;
  const int spins = setup.view_angle > 0 ? kSpins : 1;
  for (int i = 0; i < spins; ++i) {
    const double spin = spins == 1 ? 0.0 : 2 * M_PI * i / spins - M_PI;
    const auto joints = FindView(setup, request, spin);
    if (!joints) continue;
    const Vec3 to_lens = math::Normalized(CalcLaparoscopePose(setup, *joints).translation - request.p_world);
    const double cost = request.facing ? 1 - math::Dot(to_lens, *request.facing) : 0.01 * std::fabs(spin);
    if (best && !(cost < best_cost)) continue;
    best = joints;
    best_cost = cost;
  }
  return best;
}

}  // namespace trocar::scene
