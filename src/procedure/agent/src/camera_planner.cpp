// SPDX-License-Identifier: Apache-2.0
#include "camera_planner.h"

#include <algorithm>

#include "trocar/instrument/camera.h"

namespace trocar::agent {

using math::Vec3;

namespace {

constexpr double kRate = 0.25;           // of pan and tilt [rad/s]
constexpr double kSpinRate = 4 * kRate;  // of the light post [rad/s]
constexpr double kDepthRate = 0.03;      // [m/s]
constexpr double kSeenWell = 0.8;       // of the picture's width: the camera does not follow what lies within
constexpr double kFollowSeconds = 0.3;  // a tip is out of there before the picture follows [s]
constexpr double kFollowDistance = 0.09;  // of the lens from what it follows [m]
constexpr double kWorks = 0.06;           // a tool this deep is at work [m]
/// Shares of the distance that was asked for, the best first [-].
constexpr double kDistances[] = {1.0, 0.85, 1.15, 0.7, 1.3, 0.55};

}  // namespace

void AimCamera(CameraWork& camera, const scene::LaparoscopeSetup& setup, const Vec3& p, const Vec3& facing,
               double distance) {
  for (const double share : kDistances) {
    scene::ViewRequest request;
    request.p_world = p;
    request.distance = share * distance;
    request.facing = facing;
    if (const auto view = scene::FindView(setup, request)) {
      camera.to = *view;
      return;
    }
  }
}

void FollowTool(CameraWork& camera, const scene::LaparoscopeSetup& setup, const math::Pose& X_world_lens,
                const Vec3& p_tip, double depth, const Vec3& field, double dt) {
  const bool is_seen =
      depth < kWorks || instrument::IsInView(X_world_lens, kSeenWell * setup.field_of_view, p_tip);
  camera.unseen_seconds = is_seen ? 0.0 : camera.unseen_seconds + dt;
  if (camera.unseen_seconds < kFollowSeconds || !camera.HasArrived()) return;
  const Vec3 middle = 0.5 * (p_tip + field);
  AimCamera(camera, setup, middle, math::Normalized(setup.p_world_port - middle), kFollowDistance);
  camera.unseen_seconds = 0;
}

void StepCamera(CameraWork& camera, double dt) {
  const auto follow = [dt](double& now, double to, double rate) {
    now += std::clamp(to - now, -rate * dt, rate * dt);
  };
  follow(camera.now.pan, camera.to.pan, kRate);
  follow(camera.now.tilt, camera.to.tilt, kRate);
  follow(camera.now.spin, camera.to.spin, kSpinRate);
  follow(camera.now.depth, camera.to.depth, kDepthRate);
  camera.now.jaw = camera.to.jaw;
}

}  // namespace trocar::agent
