// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/free_camera.h"

namespace trocar::view {
namespace {

constexpr double kLookDistance = 0.08;  // from the lens to what is operated on [m]
constexpr double kFarDistance = 0.22;   // at which hands and organs are seen from another side [m]

}  // namespace

render::OrbitCamera MakeFreeCamera(const math::Pose& X_world_laparoscope) {
  render::OrbitCamera camera;
  camera.target = X_world_laparoscope * math::Vec3{0, 0, -kLookDistance};
  camera.distance = kLookDistance;
  camera.R_world_camera = X_world_laparoscope.rotation;
  return camera;
}

render::OrbitCamera MakeFreeCamera(const math::Pose& X_world_laparoscope, render::Viewpoint viewpoint) {
  const math::Vec3 target = X_world_laparoscope * math::Vec3{0, 0, -kLookDistance};
  render::OrbitCamera camera = LookFrom(viewpoint, {target, target}, 1);
  camera.target = target;
  camera.distance = kFarDistance;
  return camera;
}

math::Pose PoseOf(const render::OrbitCamera& camera) {
  return {camera.R_world_camera, camera.Position()};
}

}  // namespace trocar::view
