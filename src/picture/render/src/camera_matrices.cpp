// SPDX-License-Identifier: Apache-2.0
#include "camera_matrices.h"

#include <algorithm>
#include <cmath>

#include "single_precision.h"

namespace trocar::render {
namespace {

using math::Vec3;

constexpr double kNear = 0.004;  // m, in front of the lens
constexpr double kFar = 1.0;     // m, beyond any abdomen

struct Axes {
  Vec3 x, y, z;
};
Axes CalcAxes(const math::Quaternion& rotation) {
  return {math::Rotate(rotation, {1, 0, 0}), math::Rotate(rotation, {0, 1, 0}),
          math::Rotate(rotation, {0, 0, 1})};
}

}  // namespace

Matrix4 MakeMatrix(const math::Pose& pose, const Vec3& scale) {
  const Axes axes = CalcAxes(pose.rotation);
  const auto x = ToFloat(scale.x * axes.x), y = ToFloat(scale.y * axes.y), z = ToFloat(scale.z * axes.z);
  const auto t = ToFloat(pose.translation);
  return {x[0], x[1], x[2], 0, y[0], y[1], y[2], 0, z[0], z[1], z[2], 0, t[0], t[1], t[2], 1};
}

Matrix3 MakeRotation(const math::Quaternion& rotation) {
  const Axes axes = CalcAxes(rotation);
  const auto x = ToFloat(axes.x), y = ToFloat(axes.y), z = ToFloat(axes.z);
  return {x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]};
}

double CalcFocalLength(const Camera& camera, int height) {
  return 0.5 * kMaskDiameter * height / std::tan(0.5 * std::clamp(camera.field_of_view, 0.1, 2.8));
}

Matrix4 MakeProjection(const Camera& camera, int width, int height) {
  const double focal = CalcFocalLength(camera, height);
  Matrix4 m{};
  m[0] = ToFloat(2.0 * focal / width);
  m[5] = ToFloat(2.0 * focal / height);
  m[10] = ToFloat(-(kFar + kNear) / (kFar - kNear));
  m[11] = -1;
  m[14] = ToFloat(-2.0 * kFar * kNear / (kFar - kNear));
  return m;
}

}  // namespace trocar::render
