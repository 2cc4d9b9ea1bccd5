// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/orbit_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trocar/roles/roles.h"

namespace trocar::render {
namespace {

using math::Vec2;
using math::Vec3;

constexpr double kMinDistance = 1e-3, kMaxDistance = 100.0;  // m
constexpr double kZoomStep = 1.12;                           // factor a wheel step
constexpr double kRoom = 1.04;                               // around a box that is fitted

/// What the picture's axes are: towards the viewer, and up.
struct Stand {
  std::string_view name;
  Vec3 towards, up;
};
const std::array<Stand, static_cast<std::size_t>(Viewpoint::kCount)> kStands = {{
    {"anterior", {0, 0, 1}, {0, 1, 0}},
    {"posterior", {0, 0, -1}, {0, 1, 0}},
    {"right", {-1, 0, 0}, {0, 1, 0}},
    {"left", {1, 0, 0}, {0, 1, 0}},
    {"superior", {0, 1, 0}, {0, 0, 1}},
    {"inferior", {0, -1, 0}, {0, 0, 1}},
    {NameOf(roles::LandmarkRole::kUmbilicus), {0.32, -0.75, 0.58}, {0, 1, 0}},
}};

double CalcFocal(const OrbitCamera& camera, int height) {
  return 0.5 * height / std::tan(0.5 * camera.field_of_view);
}

}  // namespace

std::string_view ViewpointName(Viewpoint viewpoint) noexcept {
  return kStands[static_cast<std::size_t>(viewpoint)].name;
}

std::optional<Viewpoint> FindViewpoint(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kStands.size(); ++i) {
    if (kStands[i].name == name) return static_cast<Viewpoint>(i);
  }
  return std::nullopt;
}

Vec3 OrbitCamera::Position() const {
  return target + distance * math::Rotate(R_world_camera, {0, 0, 1});
}

OrbitCamera LookFrom(Viewpoint viewpoint, const geometry::Box& box, double aspect) {
  const Stand& stand = kStands[static_cast<std::size_t>(viewpoint)];
  const Vec3 z = math::Normalized(stand.towards);
  const Vec3 x = math::Normalized(Cross(stand.up, z));
  OrbitCamera camera;
  camera.R_world_camera = math::RotationFromAxes(x, Cross(z, x), z);
  camera.target = 0.5 * (box.min + box.max);
  // every corner of the box must fall into the picture
  const double slope = std::tan(0.5 * camera.field_of_view);
  const math::Quaternion to_camera = math::Inverse(camera.R_world_camera);
  camera.distance = kMinDistance;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                     corner & 4 ? box.max.z : box.min.z};
    const Vec3 p = math::Rotate(to_camera, at - camera.target);
    const double half = std::max(std::fabs(p.x) / aspect, std::fabs(p.y));
    camera.distance = std::max(camera.distance, kRoom * half / slope + p.z);
  }
  return camera;
}

void Orbit(OrbitCamera& camera, double dx, double dy, int height) {
  const double scale = M_PI / std::max(height, 1);
  camera.R_world_camera =
      math::Normalized(math::RotationAbout({0, 1, 0}, -scale * dx) * camera.R_world_camera *
                       math::RotationAbout({1, 0, 0}, -scale * dy));
}

void Pan(OrbitCamera& camera, double dx, double dy, int height) {
  const double metres = camera.distance / CalcFocal(camera, std::max(height, 1));
  camera.target += math::Rotate(camera.R_world_camera, {-metres * dx, metres * dy, 0});
}

void Zoom(OrbitCamera& camera, double steps) {
  camera.distance = std::clamp(camera.distance * std::pow(kZoomStep, -steps), kMinDistance, kMaxDistance);
}

Ray CalcRay(const OrbitCamera& camera, double x, double y, int width, int height) {
  const double focal = CalcFocal(camera, height);
  const Vec3 direction = {(x - 0.5 * width) / focal, (0.5 * height - y) / focal, -1};
  return {camera.Position(), math::Normalized(math::Rotate(camera.R_world_camera, direction))};
}

Vec2 CalcPixel(const OrbitCamera& camera, const Vec3& p_world, int width, int height) {
  const Vec3 p = math::Rotate(math::Inverse(camera.R_world_camera), p_world - camera.Position());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (p.z >= 0) return {kNone, kNone};
  const double focal = CalcFocal(camera, height);
  return {0.5 * width - focal * p.x / p.z, 0.5 * height + focal * p.y / p.z};
}

Vec3 CalcPointAtDepth(const OrbitCamera& camera, const Vec3& p_world, double x, double y, int width,
                      int height) {
  const Ray ray = CalcRay(camera, x, y, width, height);
  const Vec3 forward = math::Rotate(camera.R_world_camera, {0, 0, -1});
  const double depth = Dot(p_world - camera.Position(), forward);
  return ray.origin + (depth / Dot(ray.direction, forward)) * ray.direction;
}

}  // namespace trocar::render
