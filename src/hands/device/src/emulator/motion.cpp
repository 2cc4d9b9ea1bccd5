// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>

#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

constexpr double kTwoPi = 6.283185307179586;

double Swing(double time, double period, double phase = 0.0) noexcept {
  return std::sin(kTwoPi * time / period + phase);
}

}  // namespace

HandSamples CalcHandMotion(double time) noexcept {
  HandSamples hands;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const double side = i == kLeftHand ? 1.0 : -1.0;
    HandSample& hand = hands[i];
    hand.pan = 0.38 * Swing(time, 5.0, 0.7 * side);
    hand.tilt = 0.30 * side * Swing(time, 4.1);
    hand.spin = 0.8 * Swing(time, 6.3, 0.4 * side);
    hand.depth = 0.120 + 0.040 * Swing(time, 3.7, side);
    hand.jaw = 0.5 * (1.0 - Swing(time, 3.0, side)) * JawCalibration{}.max_jaw;
    hand.time = time;
    hand.is_valid = true;
  }
  return hands;
}

HandSamples CalcRest(double time) noexcept {
  HandSamples hands;
  for (HandSample& hand : hands) {
    hand.depth = 0.120;
    hand.time = time;
    hand.is_valid = true;
  }
  return hands;
}

SensorMotion MoveHands(const TrackedHandsSettings& settings, HandMotion motion) {
  return [settings, motion = std::move(motion)](int channel, double time) {
    const auto index = static_cast<std::size_t>(channel);
    return CalcSensorPose(settings.calibrations[index], settings.R_world_source, motion(time)[index]);
  };
}

SensorMotion MoveAboutTip(const TrackedHandsSettings& settings) {
  return [settings](int channel, double time) {
    const auto index = static_cast<std::size_t>(channel);
    const HandCalibration& calibration = settings.calibrations[index];
    HandSample joints = CalcHandMotion(time)[index];
    math::Pose pose = CalcSensorPose(calibration, settings.R_world_source, joints);
    // the same turning, but the tip stays where it was
    joints = CalcRest(time)[index];
    const math::Vec3 dimple =
        CalcSensorPose(calibration, settings.R_world_source, joints) * calibration.p_sensor_tip;
    pose.translation = dimple - math::Rotate(pose.rotation, calibration.p_sensor_tip);
    return pose;
  };
}

}  // namespace trocar::device
