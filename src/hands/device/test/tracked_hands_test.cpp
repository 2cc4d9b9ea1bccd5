// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/tracked_hands.h"

#include <gtest/gtest.h>

#include <cmath>

#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"

namespace trocar::device {

using math::Pose;
using math::Vec3;

namespace {

constexpr double kStep = 1.0 / 60;

class TrackedHandsTest : public testing::Test {
 protected:
  Pose PoseAt(double time) const { return MoveHands(settings_, CalcHandMotion)(kLeftHand, time); }
  const HandSample& Left(double now) {
    hands_.Collect(now, samples_);
    return samples_[kLeftHand];
  }

  TrackedHandsSettings settings_ = *MakeHandsSettings(DefaultTracker());
  TrackedHands hands_{settings_};
  HandSamples samples_;
};

TEST_F(TrackedHandsTest, FindsTheJointsThatMovedTheSensor) {
  for (int i = 0; i < 600; ++i) {
    const double time = kStep * i;
    hands_.Accept(kLeftHand, PoseAt(time), time);
    const HandSample expected = CalcHandMotion(time)[kLeftHand];
    const HandSample& found = Left(time);
    ASSERT_TRUE(found.is_valid);
    EXPECT_NEAR(found.pan, expected.pan, 1e-9);
    EXPECT_NEAR(found.tilt, expected.tilt, 1e-9);
    EXPECT_NEAR(found.spin, expected.spin, 1e-9);
    EXPECT_NEAR(found.depth, expected.depth, 1e-9);
  }
  EXPECT_EQ(hands_.Counts().jumps, 0u);
}

// faults D5
TEST_F(TrackedHandsTest, HoldsBackAGlitchAndGoesOn) {
  for (int i = 0; i < 100; ++i) {
    const double time = kStep * i;
    const double before = Left(time).depth;
    Pose pose = PoseAt(time);
    const bool is_glitch = i % 10 == 9;
    if (is_glitch) pose.translation += Vec3{0, 0.05, 0};
    hands_.Accept(kLeftHand, pose, time);
    if (is_glitch) {
      EXPECT_EQ(Left(time).depth, before);
      EXPECT_TRUE(Left(time).is_valid) << "one glitch is bridged";
    } else {
      EXPECT_NEAR(Left(time).depth, CalcHandMotion(time)[kLeftHand].depth, 1e-9);
    }
  }
  EXPECT_EQ(hands_.Counts().jumps, 10u);
}

// control: with the gate opened wide the same glitch goes through
TEST_F(TrackedHandsTest, WithoutTheGateTheGlitchWouldPass) {
  settings_.max_speed = 1e9;
  hands_ = TrackedHands(settings_);
  hands_.Accept(kLeftHand, PoseAt(0), 0);
  Pose pose = PoseAt(kStep);
  pose.translation += Vec3{0, 0.05, 0};
  hands_.Accept(kLeftHand, pose, kStep);
  EXPECT_GT(std::fabs(Left(kStep).pan - CalcHandMotion(kStep)[kLeftHand].pan), 0.1);
}

TEST_F(TrackedHandsTest, HoldsBackATurnFasterThanAHand) {
  hands_.Accept(kLeftHand, PoseAt(0), 0);
  Pose pose = PoseAt(kStep);
  pose.rotation = pose.rotation * math::RotationAbout({1, 0, 0}, 2.0);
  hands_.Accept(kLeftHand, pose, kStep);
  EXPECT_EQ(hands_.Counts().jumps, 1u);
}

TEST_F(TrackedHandsTest, TakesANewPlaceAfterTheTimeThatAHandNeedsToGetThere) {
  hands_.Accept(kLeftHand, PoseAt(0), 0);
  int refused = 0;
  for (int i = 1; i < 10; ++i) {
    Pose pose = PoseAt(0);
    pose.translation += Vec3{0, 0.10, 0};
    const std::uint64_t before = hands_.Counts().accepted;
    hands_.Accept(kLeftHand, pose, kStep * i);
    refused += hands_.Counts().accepted == before ? 1 : 0;
  }
  // 0.10 m at 2 m/s are 50 ms, three steps of 16.7 ms less the slack
  EXPECT_EQ(refused, 2);
  EXPECT_TRUE(Left(kStep * 10).is_valid);
}

TEST_F(TrackedHandsTest, TurnsHemisphereFlipsBack) {
  for (int i = 0; i < 300; ++i) {
    const double time = kStep * i;
    Pose pose = PoseAt(time);
    if (i % 50 > 20) pose.translation = -pose.translation;
    hands_.Accept(kLeftHand, pose, time);
    EXPECT_NEAR(Left(time).depth, CalcHandMotion(time)[kLeftHand].depth, 1e-9);
  }
  EXPECT_GT(hands_.Counts().flips, 100u);
  EXPECT_EQ(hands_.Counts().jumps, 0u);
}

TEST_F(TrackedHandsTest, ChoosesTheHemisphereOfTheSettingsAtFirst) {
  Pose pose = PoseAt(0);
  pose.translation = -pose.translation;
  hands_.Accept(kLeftHand, pose, 0);
  EXPECT_GT(math::Dot(hands_.GetPose(kLeftHand)->translation, settings_.hemisphere), 0.0);

  settings_.has_hemisphere_doubt = false;
  hands_ = TrackedHands(settings_);
  hands_.Accept(kLeftHand, pose, 0);
  EXPECT_LT(math::Dot(hands_.GetPose(kLeftHand)->translation, settings_.hemisphere), 0.0);
}

TEST_F(TrackedHandsTest, KnowsThatMinusQIsQ) {
  for (int i = 0; i < 60; ++i) {
    Pose pose = PoseAt(kStep * i);
    math::Quaternion& q = pose.rotation;
    if (i % 2 == 1) q = {-q.w, -q.x, -q.y, -q.z};
    hands_.Accept(kLeftHand, pose, kStep * i);
  }
  EXPECT_EQ(hands_.Counts().accepted, 60u);
}

// faults D4
TEST_F(TrackedHandsTest, DropsWhatIsNotFiniteAndHidesTheHandAfterThree) {
  hands_.Accept(kLeftHand, PoseAt(0), 0);
  for (int i = 1; i <= 3; ++i) {
    EXPECT_TRUE(Left(0.001 * i).is_valid);
    Pose pose = PoseAt(0);
    pose.translation.x = i == 2 ? INFINITY : std::nan("");
    hands_.Accept(kLeftHand, pose, 0.001 * i);
  }
  EXPECT_FALSE(Left(0.004).is_valid);
  EXPECT_EQ(hands_.Counts().implausible, 3u);
  hands_.Accept(kLeftHand, PoseAt(0.005), 0.005);
  EXPECT_TRUE(Left(0.005).is_valid);
}

// faults D2
TEST_F(TrackedHandsTest, HidesAHandThatNoRecordNames) {
  hands_.Accept(kLeftHand, PoseAt(0), 0);
  hands_.Accept(kRightHand, MoveHands(settings_, CalcHandMotion)(kRightHand, 0), 0);
  EXPECT_TRUE(hands_.Collect(0.0, samples_));
  EXPECT_FALSE(hands_.Collect(0.04, samples_)) << "nothing new";
  const double depth = samples_[kLeftHand].depth;
  EXPECT_TRUE(hands_.Collect(0.06, samples_)) << "going out of sight is news";
  EXPECT_FALSE(samples_[kLeftHand].is_valid);
  EXPECT_EQ(samples_[kLeftHand].depth, depth) << "the last pose is held";
}

TEST_F(TrackedHandsTest, SpinDoesNotJumpAtHalfATurn) {
  double last = 0;
  for (int i = 0; i < 400; ++i) {
    HandSample joints = CalcRest(0)[kLeftHand];
    joints.spin = 0.02 * i;
    hands_.Accept(kLeftHand,
                  CalcSensorPose(settings_.calibrations[kLeftHand], settings_.R_world_source, joints),
                  kStep * i);
    EXPECT_NEAR(Left(kStep * i).spin - last, i == 0 ? 0.0 : 0.02, 1e-9);
    last = Left(kStep * i).spin;
  }
  EXPECT_GT(last, 6.5);
}

TEST_F(TrackedHandsTest, IgnoresChannelsThatAreNone) {
  hands_.Accept(-1, PoseAt(0), 0);
  hands_.Accept(kChannelCount, PoseAt(0), 0);
  EXPECT_EQ(hands_.Counts().accepted, 0u);
  EXPECT_EQ(hands_.GetPose(kChannelCount), nullptr);
}

}  // namespace
}  // namespace trocar::device
