// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"
#include "trocar/device/hand_calibration.h"

namespace trocar::device {
namespace {

using core::ErrorCode;

/// An instrument whose sensor sits askew on the handle.
TrackedHandsSettings MakeTruth() {
  TrackedHandsSettings settings = *MakeHandsSettings(DefaultTracker());
  HandCalibration& hand = settings.calibrations[kLeftHand];
  hand.p_sensor_tip = {0.281, -0.023, 0.017};
  hand.axis_sensor = math::Normalized(Vec3{0.96, 0.11, -0.21});
  hand.up_sensor = math::Normalized(math::Cross(hand.axis_sensor, {0, 1, 0}));
  hand.p_source_trocar = {0.37, -0.09, 0.04};
  return settings;
}

std::vector<Pose> Sample(const SensorMotion& motion, int count = 100, double seconds = 20.0) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) poses.push_back(motion(kLeftHand, seconds * i / count));
  return poses;
}

void AddNoise(std::vector<Pose>& poses, double size, std::uint64_t seed) {
  math::Random random(seed);
  for (Pose& pose : poses)
    pose.translation +=
        Vec3{random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

// analytic: two turns about a point that is known
TEST(FitPivot, FindsThePointThatStoodStill) {
  const TrackedHandsSettings truth = MakeTruth();
  const auto fit = FitPivot(Sample(MoveAboutTip(truth)));
  ASSERT_TRUE(fit.ok()) << fit.error().Text();
  EXPECT_LT(math::Distance(fit->p_sensor_pivot, truth.calibrations[kLeftHand].p_sensor_tip), 1e-9);
  EXPECT_LT(fit->quality.residual, 1e-9);
  EXPECT_GT(fit->quality.spread, kMinFitSpread);
}

TEST(FitPivot, SaysHowNoisyItWas) {
  const TrackedHandsSettings truth = MakeTruth();
  std::vector<Pose> poses = Sample(MoveAboutTip(truth), 400);
  AddNoise(poses, 0.001, 7);
  const auto fit = FitPivot(poses);
  ASSERT_TRUE(fit.ok());
  // uniform noise of +-1 mm in three axes has an RMS length of 1 mm
  EXPECT_NEAR(fit->quality.residual, 0.001, 0.0001);
  EXPECT_LT(math::Distance(fit->p_sensor_pivot, truth.calibrations[kLeftHand].p_sensor_tip), 0.0007);
}

TEST(FitPivot, RefusesTooFewTooLittleAndNotStill) {
  const TrackedHandsSettings truth = MakeTruth();
  const auto code = [](const std::vector<Pose>& poses) {
    const auto fit = FitPivot(poses);
    return fit.ok() ? ErrorCode::kNone : fit.error().code;
  };
  EXPECT_EQ(code(Sample(MoveAboutTip(truth), 11)), ErrorCode::kCalibrationPoor);
  EXPECT_EQ(code(Sample(MoveAboutTip(truth), 100, 0.2)), ErrorCode::kCalibrationPoor) << "hardly turned";
  EXPECT_EQ(code(Sample(MoveHands(truth, CalcHandMotion))), ErrorCode::kCalibrationPoor)
      << "the tip moved about";
  std::vector<Pose> poses = Sample(MoveAboutTip(truth));
  poses[5].translation.y = std::nan("");
  EXPECT_EQ(code(poses), ErrorCode::kCalibrationPoor);
  const std::vector<Pose> still(100, poses[0]);
  EXPECT_EQ(code(still), ErrorCode::kCalibrationPoor);
}

TEST(FitTrocar, FindsTrocarAndShaft) {
  const TrackedHandsSettings truth = MakeTruth();
  const HandCalibration& hand = truth.calibrations[kLeftHand];
  const auto fit = FitTrocar(Sample(MoveHands(truth, CalcHandMotion)), hand.p_sensor_tip);
  ASSERT_TRUE(fit.ok()) << fit.error().Text();
  EXPECT_LT(math::Distance(fit->p_source_trocar, hand.p_source_trocar), 1e-6);
  EXPECT_LT(math::Distance(fit->axis_sensor, hand.axis_sensor), 1e-6);
  EXPECT_LT(fit->quality.residual, 1e-6);
}

TEST(FitTrocar, StandsNoise) {
  const TrackedHandsSettings truth = MakeTruth();
  const HandCalibration& hand = truth.calibrations[kLeftHand];
  std::vector<Pose> poses = Sample(MoveHands(truth, CalcHandMotion), 400);
  AddNoise(poses, 0.001, 9);
  const auto fit = FitTrocar(poses, hand.p_sensor_tip);
  ASSERT_TRUE(fit.ok());
  EXPECT_LT(math::Distance(fit->p_source_trocar, hand.p_source_trocar), 0.001);
  EXPECT_LT(math::Distance(fit->axis_sensor, hand.axis_sensor), 0.01);
}

TEST(FitTrocar, RefusesATrocarThatMovedAndASmallSwing) {
  const TrackedHandsSettings truth = MakeTruth();
  const Vec3 tip = truth.calibrations[kLeftHand].p_sensor_tip;
  std::vector<Pose> poses = Sample(MoveHands(truth, CalcHandMotion));
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].translation.z += i < 50 ? 0.0 : 0.02;
  const auto moved = FitTrocar(poses, tip);
  ASSERT_FALSE(moved.ok());
  EXPECT_EQ(moved.error().code, ErrorCode::kCalibrationPoor);
  EXPECT_FALSE(FitTrocar(Sample(MoveHands(truth, CalcHandMotion), 100, 0.2), tip).ok());
  EXPECT_FALSE(FitTrocar(Sample(MoveHands(truth, CalcRest)), tip).ok());
}

TEST(SourceRotation, PutsThePersonsRightAndUpIntoTheWorld) {
  const auto rotation = FindSourceRotation({0, 1, 0}, {0, 0, -1});
  ASSERT_TRUE(rotation.ok());
  EXPECT_LT(math::Distance(math::Rotate(*rotation, {0, 1, 0}), {1, 0, 0}), 1e-12);
  EXPECT_LT(math::Distance(math::Rotate(*rotation, {0, 0, -1}), {0, 0, 1}), 1e-12);
  EXPECT_LT(math::Distance(math::Rotate(*rotation, {1, 0, 0}), {0, 1, 0}), 1e-12)
      << "away from the person is cranial";
  EXPECT_FALSE(FindSourceRotation({1, 0, 0}, {1, 0.5, 0}).ok());
  EXPECT_FALSE(FindSourceRotation({0, 0, 0}, {0, 0, 1}).ok());
}

// the tip at the trocar: the shaft still says where it points
TEST(HandJoints, AreSteadyAroundTheTrocar) {
  const TrackedHandsSettings truth = MakeTruth();
  const HandCalibration& hand = truth.calibrations[kLeftHand];
  for (double depth = -0.02; depth < 0.1; depth += 0.0007) {
    HandSample joints;
    joints.pan = 0.3, joints.tilt = -0.2, joints.spin = 0.5, joints.depth = depth;
    HandSample found;
    SetJoints(hand, truth.R_world_source, CalcSensorPose(hand, truth.R_world_source, joints), found);
    EXPECT_NEAR(found.pan, 0.3, 1e-9) << depth;
    EXPECT_NEAR(found.tilt, -0.2, 1e-9) << depth;
    EXPECT_NEAR(found.depth, depth, 1e-9);
  }
}

}  // namespace
}  // namespace trocar::device
