// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/neighbour_contact.h"

#include <gtest/gtest.h>

#include <limits>

#include "trocar/geometry/primitives.h"
#include "trocar/instrument/trocar_kinematics.h"

namespace trocar::surgery {

using math::Pose;
using math::Vec3;

namespace {

/// A ball of 30 mm below a port, and a grasper that is driven straight down on it.
class BallUnderAPort : public testing::Test {
 protected:
  static constexpr Vec3 kPort{0, 0, 0.12};
  static constexpr Vec3 kCentre{0, 0, 0};
  static constexpr double kRadius = 0.030;

  void MakeBall(double stiffness, double deepest) {
    const NeighbourSurface ball{geometry::MakeSphere(kCentre, kRadius, 3), stiffness, deepest};
    auto made = NeighbourContact::Make(std::span(&ball, 1));
    ASSERT_TRUE(made.ok());
    contact_ = std::move(*made);
    contact_.Reset();
    tool_ = *instrument::FindTool("grasper");
    proxy_ = proxy_before_ =
        instrument::CalcToolPose(kPort, instrument::FindJoints(kPort, {0, 0, 0.05}, 0, 0));
    offset_ = {};
  }

  /// One tick with the hand's tip at z below the port.
  void Step(double z) {
    ToolDrive drive{kPort, instrument::FindJoints(kPort, {0, 0, z}, 0, 0)};
    const Pose device = instrument::CalcToolPose(kPort, drive.device);
    const ToolMotion motion{&tool_, 0, proxy_before_, proxy_, device, 0, 0, -1};
    contact_.Find(std::span(&motion, 1));
    contact_.Press(true);
    ProxyLimits limits;
    contact_.AddLimits(0, limits);
    proxy_before_ = proxy_;
    instrument::TrocarJoints joints;
    for (int round = 0; round < 4; ++round) {
      joints = FindProxy(drive, offset_, limits.limits);
      proxy_ = instrument::CalcToolPose(kPort, joints);
      if (AddOverlapLimits(tool_, proxy_, device, 0, contact_.Candidates(), -1, limits) == 0) break;
    }
    offset_ = {joints.pan - drive.device.pan, joints.tilt - drive.device.tilt, 0,
               joints.depth - drive.device.depth, 0};
  }
  double Tip() const { return proxy_.translation.z; }

  NeighbourContact contact_;
  instrument::Tool tool_;
  Pose proxy_, proxy_before_;
  instrument::TrocarJoints offset_;
};

TEST_F(BallUnderAPort, StopsAToolAndPushesBack) {
  MakeBall(std::numeric_limits<double>::infinity(), 0.0);
  for (int tick = 0; tick < 60; ++tick) Step(0.05 - 0.0005 * tick);
  // the hand is 10 mm in the ball, the tool is not
  EXPECT_GT(Tip(), kRadius - 0.0008);
  EXPECT_LT(Tip(), kRadius + 0.004);
  EXPECT_GT(contact_.ForceOn(0).z, 0.3);
  EXPECT_EQ(contact_.Dents()[0].push, Vec3{});
  for (int tick = 0; tick < 60; ++tick) Step(0.05);
  EXPECT_EQ(contact_.ForceOn(0), Vec3{});
}

TEST_F(BallUnderAPort, GivesWayAndComesToRest) {
  MakeBall(150.0, 0.010);
  for (int tick = 0; tick < 300; ++tick) Step(std::max(0.022, 0.05 - 0.0005 * tick));
  const Dent pressed = contact_.Dents()[0];
  const double force = contact_.ForceOn(0).z;
  EXPECT_EQ(pressed.neighbour, 0);
  EXPECT_LT(pressed.push.z, -0.001);
  EXPECT_GT(force, 0.1);
  // what it gives way is what the force asks for
  EXPECT_NEAR(-pressed.push.z, force / 150.0, 0.0003);
  EXPECT_LT(Tip(), kRadius - 0.0005);
  for (int tick = 0; tick < 20; ++tick) Step(0.022);
  EXPECT_NEAR(contact_.ForceOn(0).z, force, 0.02 * force);
  // and springs back
  for (int tick = 0; tick < 300; ++tick) Step(0.06);
  EXPECT_EQ(contact_.Dents()[0].neighbour, -1);
}

TEST_F(BallUnderAPort, GivesWayNoFartherThanItMay) {
  MakeBall(20.0, 0.003);
  for (int tick = 0; tick < 300; ++tick) Step(std::max(0.005, 0.05 - 0.0005 * tick));
  EXPECT_NEAR(math::Norm(contact_.Dents()[0].push), 0.003, 1e-6);
}

TEST_F(BallUnderAPort, GoesOnTheSameFromASavedState) {
  MakeBall(150.0, 0.010);
  for (int tick = 0; tick < 70; ++tick) Step(std::max(0.022, 0.05 - 0.0005 * tick));
  std::vector<std::byte> bytes;
  base::StateArchive save = base::StateArchive::ForSave(bytes);
  contact_.VisitState(save);
  const Pose proxy = proxy_, before = proxy_before_;
  const auto offset = offset_;
  for (int tick = 0; tick < 5; ++tick) Step(0.022);
  const Vec3 force = contact_.ForceOn(0);
  const Dent dent = contact_.Dents()[0];

  for (int tick = 0; tick < 9; ++tick) Step(0.07);
  base::StateArchive restore = base::StateArchive::ForRestore(bytes);
  contact_.VisitState(restore);
  ASSERT_TRUE(restore.ok());
  proxy_ = proxy, proxy_before_ = before, offset_ = offset;
  for (int tick = 0; tick < 5; ++tick) Step(0.022);
  EXPECT_EQ(contact_.ForceOn(0), force);
  EXPECT_EQ(contact_.Dents()[0].push, dent.push);
}

TEST(Dent, FadesOutSmoothly) {
  const Dent dent{0, {0, 0, 0}, {0, 0, -0.01}};
  EXPECT_EQ(dent.ShiftOf({0, 0, 0}), dent.push);
  EXPECT_EQ(dent.ShiftOf({kDentRadius, 0, 0}), Vec3{});
  EXPECT_LT(dent.ShiftOf({0.01, 0, 0}).z, dent.ShiftOf({0.02, 0, 0}).z);
}

}  // namespace
}  // namespace trocar::surgery
