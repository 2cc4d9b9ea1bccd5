// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"
#include "trocar/device/hand_calibration.h"

namespace trocar::device {

using math::Pose;
using math::Quaternion;
using math::Vec3;

namespace {

using base::ErrorCode;

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

/// Poses of a sensor whose tip stands at p_source_tip while the handle is turned so.
std::vector<Pose> TurnAbout(const Vec3& p_sensor_tip, const Vec3& p_source_tip,
                            const std::function<Quaternion(double)>& turn, int count = 200) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const Quaternion rotation = turn(6.283185307179586 * i / count);
    poses.push_back({rotation, p_source_tip - math::Rotate(rotation, p_sensor_tip)});
  }
  return poses;
}

/// Swings by +-25 degrees about y, and by so much about z.
std::function<Quaternion(double)> Swing(double across) {
  return [across](double phase) {
    return math::RotationAbout({0, 1, 0}, 0.436 * std::sin(phase)) *
           math::RotationAbout({0, 0, 1}, across * std::cos(phase));
  };
}

// a swing in one plane fits any tip along its axis: the residual says nothing, the singular value does
TEST(FitPivot, RefusesASwingInOnePlaneAndSaysWhichMotionIsMissing) {
  const Vec3 tip{0.25, 0.01, -0.02}, hole{0.4, 0.05, 0.1};
  for (const double noise : {0.0, 1e-9, 1e-5, 0.0005}) {
    std::vector<Pose> poses = TurnAbout(tip, hole, Swing(0));
    AddNoise(poses, noise, 11);
    const auto planar = FitPivot(poses);
    ASSERT_FALSE(planar.ok()) << noise << ": tip " << math::Norm(planar->p_sensor_pivot) << " m away";
    EXPECT_EQ(planar.error().code, ErrorCode::kCalibrationPoor);
    EXPECT_NE(planar.error().message.find("one axis only"), std::string::npos) << planar.error().message;
    EXPECT_NE(planar.error().message.find("as well as sideways"), std::string::npos);
  }
  // turned about the shaft alone, by any angle: where the tip lies along it stays unknown
  const auto rolled = FitPivot(TurnAbout(tip, hole, [](double phase) {
    return math::RotationAbout({1, 0, 0}, phase);
  }));
  ASSERT_FALSE(rolled.ok());
  EXPECT_NE(rolled.error().message.find("one axis only"), std::string::npos) << rolled.error().message;
}

// the control: the same swing, and 6 degrees RMS across it
TEST(FitPivot, TakesASwingThatLeavesItsPlane) {
  const Vec3 tip{0.25, 0.01, -0.02}, hole{0.4, 0.05, 0.1};
  const auto fit = FitPivot(TurnAbout(tip, hole, Swing(0.15)));
  ASSERT_TRUE(fit.ok()) << fit.error().Text();
  EXPECT_LT(math::Distance(fit->p_sensor_pivot, tip), 1e-9);
  // analytic: the direction that only the small swing moves has its RMS, 0.15 / sqrt(2)
  EXPECT_NEAR(fit->quality.motion, 0.15 / std::sqrt(2.0), 0.005);
}

// the true error lies within what the fit admits, in at least 19 of 20 trials
TEST(FitPivot, AdmitsItsError) {
  const Vec3 tip{0.25, 0.01, -0.02}, hole{0.4, 0.05, 0.1};
  int admitted = 0;
  constexpr int kTrials = 40;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    std::vector<Pose> poses = TurnAbout(tip, hole, Swing(0.25), 2 * static_cast<int>(kMinFitPoses));
    AddNoise(poses, 0.001, 100 + trial);
    const auto fit = FitPivot(poses);
    ASSERT_TRUE(fit.ok()) << fit.error().Text();
    if (math::Distance(fit->p_sensor_pivot, tip) <= fit->quality.uncertainty) ++admitted;
    EXPECT_LT(fit->quality.uncertainty, 0.005);
  }
  EXPECT_GE(admitted, 38);
}

// enough of a motion to be solved, too little for the noise
TEST(FitPivot, RefusesWhatIsKnownTooPoorly) {
  std::vector<Pose> poses = TurnAbout({0.25, 0, 0}, {0.4, 0, 0}, Swing(0.08));
  EXPECT_TRUE(FitPivot(poses).ok());
  AddNoise(poses, 0.002, 3);
  const auto fit = FitPivot(poses);
  ASSERT_FALSE(fit.ok());
  EXPECT_NE(fit.error().message.find("known to"), std::string::npos) << fit.error().message;
}

TEST(FitPivot, RefusesATipThatNoInstrumentHas) {
  EXPECT_TRUE(FitPivot(TurnAbout({0.59, 0, 0}, {0.4, 0, 0}, Swing(0.3))).ok());
  const auto far = FitPivot(TurnAbout({0.61, 0, 0}, {0.4, 0, 0}, Swing(0.3)));
  ASSERT_FALSE(far.ok());
  EXPECT_NE(far.error().message.find("610 mm"), std::string::npos) << far.error().message;
  EXPECT_FALSE(FitPivot(TurnAbout({0.3, 0, 0}, {5.1, 0, 0}, Swing(0.3))).ok()) << "beyond the source's reach";
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

/// A sensor on the shaft's axis, 0.3 m behind the tip, in a trocar at the origin of the swing.
std::vector<Pose> MoveInTrocar(double across, double in_and_out, double spin,
                               const Vec3& trocar = {0.4, 0, 0}) {
  std::vector<Pose> poses;
  for (int i = 0; i < 200; ++i) {
    const double phase = 6.283185307179586 * i / 200;
    const Quaternion rotation =
        Swing(across)(phase) * math::RotationAbout({1, 0, 0}, spin * std::sin(2 * phase + 1));
    const double depth = 0.12 + in_and_out * std::sin(3 * phase);
    poses.push_back({rotation, trocar + math::Rotate(rotation, {depth - 0.3, 0, 0})});
  }
  return poses;
}

TEST(FitTrocar, SaysWhichMotionIsMissing) {
  const Vec3 tip{0.3, 0, 0};
  EXPECT_TRUE(FitTrocar(MoveInTrocar(0.3, 0.04, 0), tip).ok());
  EXPECT_TRUE(FitTrocar(MoveInTrocar(0.3, 0, 1.0), tip).ok()) << "turning about the shaft does as well";
  const auto held = FitTrocar(MoveInTrocar(0.3, 0, 0), tip);
  ASSERT_FALSE(held.ok());
  EXPECT_EQ(held.error().code, ErrorCode::kCalibrationPoor);
  EXPECT_NE(held.error().message.find("in and out"), std::string::npos) << held.error().message;
  EXPECT_FALSE(FitTrocar(MoveInTrocar(0, 0, 0), tip).ok()) << "in one plane";
}

TEST(FitTrocar, RefusesATrocarOutOfReach) {
  const Vec3 tip{0.3, 0, 0};
  EXPECT_TRUE(FitTrocar(MoveInTrocar(0.3, 0.04, 1.0, {4.9, 0, 0}), tip).ok());
  const auto far = FitTrocar(MoveInTrocar(0.3, 0.04, 1.0, {5.1, 0, 0}), tip);
  ASSERT_FALSE(far.ok());
  EXPECT_NE(far.error().message.find("5100 mm"), std::string::npos) << far.error().message;
}

TEST(FitQuality, IsShownInMillimetres) {
  FitQuality quality;
  quality.uncertainty = 0.00123, quality.residual = 0.0005;
  EXPECT_NE(FormatQuality(quality, 40).find("known to 1.2 mm"), std::string::npos);
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
