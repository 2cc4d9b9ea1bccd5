// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/hand_calibration.h"

#include <algorithm>
#include <cmath>

namespace trocar::device {

using math::Pose;
using math::Quaternion;
using math::Vec3;

namespace {

/// Nearer to the trocar than this the tip does not say where the shaft points; further than the second it does [m].
constexpr double kBlindDepth = 0.010, kSureDepth = 0.030;

/// R_sensor_tool: z back along the shaft, y where the jaws open.
Quaternion ToolInSensor(const HandCalibration& calibration) noexcept {
  const Vec3 z = -calibration.axis_sensor;
  const Vec3 x = math::Normalized(math::Cross(calibration.up_sensor, z), math::AnyPerpendicular(z));
  return math::RotationFromAxes(x, math::Cross(z, x), z);
}

Quaternion PanTilt(double pan, double tilt) noexcept {
  return math::RotationAbout({0, 1, 0}, pan) * math::RotationAbout({1, 0, 0}, tilt);
}

}  // namespace

void SetJoints(const HandCalibration& calibration, const Quaternion& R_world_source,
               const Pose& X_source_sensor, HandSample& sample) noexcept {
  const Vec3 shaft = math::Rotate(X_source_sensor.rotation, calibration.axis_sensor);
  const Vec3 way = X_source_sensor * calibration.p_sensor_tip - calibration.p_source_trocar;
  const double inside = math::Dot(way, shaft);
  // the tip decides, except where it is so near to the trocar that its error would turn the shaft
  const double trust = std::clamp((inside - kBlindDepth) / (kSureDepth - kBlindDepth), 0.0, 1.0);
  const Vec3 along = math::Normalized(math::Lerp(shaft, math::Normalized(way, shaft), trust), shaft);
  const Vec3 a = math::Rotate(R_world_source, along);
  sample.depth = inside + trust * (math::Norm(way) - inside);
  sample.tilt = std::asin(std::clamp(a.y, -1.0, 1.0));
  sample.pan = std::atan2(-a.x, -a.z);

  const Vec3 up = math::Rotate(R_world_source,
                               math::Rotate(X_source_sensor.rotation * ToolInSensor(calibration), {0, 1, 0}));
  const Quaternion unspun = PanTilt(sample.pan, sample.tilt);
  sample.spin = std::atan2(-math::Dot(up, math::Rotate(unspun, {1, 0, 0})),
                           math::Dot(up, math::Rotate(unspun, {0, 1, 0})));
}

Pose CalcSensorPose(const HandCalibration& calibration, const Quaternion& R_world_source,
                    const HandSample& joints) noexcept {
  const Quaternion R_source_world = math::Inverse(R_world_source);
  const Quaternion unspun = PanTilt(joints.pan, joints.tilt);
  const Quaternion R_world_tool = unspun * math::RotationAbout({0, 0, 1}, joints.spin);
  Pose X_source_sensor;
  X_source_sensor.rotation =
      math::Normalized(R_source_world * R_world_tool * math::Inverse(ToolInSensor(calibration)));
  const Vec3 a = math::Rotate(unspun, {0, 0, -1});
  const Vec3 tip = calibration.p_source_trocar + math::Rotate(R_source_world, a * joints.depth);
  X_source_sensor.translation = tip - math::Rotate(X_source_sensor.rotation, calibration.p_sensor_tip);
  return X_source_sensor;
}

base::Result<Quaternion> FindSourceRotation(const Vec3& right, const Vec3& up) {
  constexpr double kMostCosine = 0.17364817766693033;  // of 80 degrees
  const double lengths = math::Norm(right) * math::Norm(up);
  if (!(lengths > 0.0) || !(std::fabs(math::Dot(right, up)) <= kMostCosine * lengths)) {
    return base::Error{
        base::ErrorCode::kDeviceSettings,
        "the directions \"right\" and \"up\" of the tracker's source are not at right angles; look at the "
        "axes printed on it"};
  }
  // rows are the world's axes as the source sees them
  const Vec3 z = math::Normalized(up);
  const Vec3 x = math::Normalized(right - z * math::Dot(right, z));
  return math::Inverse(math::RotationFromAxes(x, math::Cross(z, x), z));
}

}  // namespace trocar::device
