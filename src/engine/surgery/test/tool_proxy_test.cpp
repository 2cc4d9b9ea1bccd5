// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/tool_proxy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "organ_fixture.h"
#include "trocar/surgery/tools_contact.h"

namespace trocar::surgery {

using math::Pose;
using math::Vec3;

namespace {

using ToolProxy = OrganFixture;

TEST_F(ToolProxy, IsTheDeviceInFreeAir) {
  Place(JointsAt({0.01, 0, 0.05}));
  const auto device = JointsAt({0.012, 0.003, 0.045});
  (void)Tick(device);
  EXPECT_EQ(proxy_, device);
  EXPECT_EQ(overlap_, 0.0);
}

TEST_F(ToolProxy, StaysOutsideWhereTheDeviceEnters) {
  Place(JointsAt({0, 0, 0.03}));
  double deepest = 0;
  for (double z = 0.024; z > 0.008; z -= 0.0005) {
    const auto device = JointsAt({0.001, 0, z});
    (void)Tick(device);
    EXPECT_LT(overlap_, 2e-5) << z;
    deepest = std::max(deepest, device.depth - proxy_.depth);
  }
  EXPECT_GT(deepest, 0.0002) << "the hand is deeper than the tool";
  EXPECT_LT(deepest, 0.01) << "and the tissue gives way with the tool";
}

TEST_F(ToolProxy, ComesBackToTheDeviceSmoothly) {
  Place(JointsAt({0, 0, 0.03}));
  for (int tick = 0; tick < 20; ++tick) (void)Tick(JointsAt({0, 0, 0.014}));
  const auto out = JointsAt({0, 0, 0.04});
  double last = std::abs(offset_.depth);
  EXPECT_GT(last, 2e-5);
  for (int tick = 0; tick < 60; ++tick) {
    (void)Tick(out);
    EXPECT_LE(std::abs(offset_.depth), last + 1e-12);
    last = std::abs(offset_.depth);
  }
  EXPECT_EQ(proxy_, out);
}

// Jaws that close around a fold do not throw the tool back.
TEST_F(ToolProxy, IsNotPushedOutByWhatItsJawsPinch) {
  Place(JointsAt({0, 0, 0.03}, 0.8));
  for (double z = 0.028; z > 0.016; z -= 0.001) (void)Tick(JointsAt({0, 0, z}, 0.8));
  double farthest = 0;
  for (double jaw = 0.8; jaw > 0.22; jaw -= 0.02) {
    (void)Tick(JointsAt({0, 0, 0.016}, jaw));
    farthest = std::max(farthest, std::abs(offset_.depth));
  }
  EXPECT_LT(farthest, 0.003);
}

// The trocar is a fixed point of the proxy too.
TEST_F(ToolProxy, PassesThroughTheTrocar) {
  Place(JointsAt({0.03, 0, -0.08}));
  for (double x = 0.03; x > 0.012; x -= 0.001) {
    (void)Tick(JointsAt({x, 0, -0.08}));
    const Vec3 tip = X_proxy_.translation, up = X_proxy_ * Vec3{0, 0, 1} - tip;
    const Vec3 nearest = tip + math::Dot(kPort - tip, up) * up;
    EXPECT_LT(math::Distance(nearest, kPort), 1e-12);
  }
}

// Analytic: one plane across the shaft's way moves the depth alone; one beside the tip turns the shaft.
TEST(FindProxy, GivesWayInTheJointThatHelps) {
  const ToolDrive drive{{0, 0, 0.2}, instrument::FindJoints({0, 0, 0.2}, {0, 0, 0}, 0.3, 0.1)};
  const auto above = FindProxy(drive, {}, std::vector<ProxyLimit>{{{0, 0, 0}, {0, 0, -1}, -0.003}});
  EXPECT_NEAR(above.depth, 0.197, 2e-5);
  EXPECT_NEAR(above.pan, drive.device.pan, 1e-9);
  EXPECT_EQ(above.spin, 0.3);
  EXPECT_EQ(above.jaw, 0.1);
  const auto beside = FindProxy(drive, {}, std::vector<ProxyLimit>{{{0, 0, 0}, {1, 0, 0}, -0.002}});
  const Vec3 tip = instrument::CalcToolPose(drive.p_world_port, beside).translation;
  EXPECT_NEAR(tip.x, -0.002, 2e-5);
  EXPECT_NEAR(beside.depth, 0.2, 1e-9);
  const auto free = FindProxy(drive, {}, std::vector<ProxyLimit>{{{0, 0, 0}, {1, 0, 0}, 0.002}});
  EXPECT_EQ(free, drive.device) << "a plane that is not reached does nothing";
}

// Two walls of a narrow fold that leave no room: the nearest free place is 50 times farther away than they overlap.
TEST(FindProxy, DoesNotLeapOutOfANarrowFold) {
  const ToolDrive drive{{0, 0, 0.2}, instrument::FindJoints({0, 0, 0.2}, {0, 0, 0}, 0.0, 0.0)};
  const double slope = 0.02, overlap = 1e-4;
  std::vector<ProxyLimit> walls;
  for (const double side : {-1.0, 1.0})
    walls.push_back({{0, 0, 0}, math::Normalized(Vec3{side, slope, 0}), -overlap});
  const auto proxy = FindProxy(drive, {}, walls);
  const Vec3 tip = instrument::CalcToolPose(drive.p_world_port, proxy).translation;
  EXPECT_LT(math::Norm(tip), 15 * overlap);
  EXPECT_LT(tip.y, -overlap) << "but it goes the way that opens";
}

// The wire of a hook is one rod: what it presses, however it lies, holds it back.
TEST_F(ToolProxy, AHookHasNoJawsThatPinch) {
  const instrument::Tool hook = *instrument::FindTool("hook");
  const Pose X;
  EXPECT_FALSE(IsPinch(hook, ToolBody::kUpperJaw, X, {0, -1, 0}));
  EXPECT_TRUE(IsPinch(tool_, ToolBody::kUpperJaw, X, {0, -1, 0})) << "a grasper does";
  tool_ = hook;
  // from beside, along its toe
  Place(JointsAt({0, 0.03, 0.004}));
  for (double y = 0.03; y > 0.012; y -= 0.0005) (void)Tick(JointsAt({0, y, 0.004}));
  EXPECT_LT(overlap_, 2e-5);
  for (const ContactLink& link : contacts_.links)
    EXPECT_NE((link.key >> 48) & 0xff, static_cast<std::uint64_t>(ToolBody::kLowerJaw)) << "one rod, once";
  EXPECT_FALSE(contacts_.links.empty());
}

// Beside a sharp rim the face that happens to be nearest may look away: that alone does not make the tool lie inside.
TEST_F(ToolProxy, LiesOutsideBesideASharpRim) {
  // a wedge that points at the shaft: two long faces that meet at x = 0 under 20 degrees, closed behind
  const double far = 0.06, half = 0.0106;
  const geometry::TriangleMesh wedge{
      {{0, -far, 0},
       {0, far, 0},
       {-far, -far, half},
       {-far, far, half},
       {-far, -far, -half},
       {-far, far, -half}},
      {{0, 1, 3}, {0, 3, 2}, {1, 0, 4}, {1, 4, 5}, {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}}};
  state_.position.assign(wedge.positions.begin(), wedge.positions.end());
  before_ = state_.position;
  auto surface = MakeOrganSurface(state_.position, 0, wedge);
  ASSERT_TRUE(surface.ok());
  organs_ = {std::move(*surface)};
  UpdateOrganSurface(organs_[0], state_.position);
  motion_ = {0.0};
  const double gap = 0.0005;  // the shaft overlaps the rim by the rest of its radius
  for (const double height : {-0.0004, -0.0001, 0.0001, 0.0004}) {
    const auto joints = instrument::FindJoints({gap, 0, 0.15}, {gap, 0, -0.1}, 0.0, 0.0);
    const Pose X = instrument::CalcToolPose({gap, height, 0.15}, joints);
    ProxyLimits limits;
    const ContactCandidates candidates{organs_, nullptr, state_.position, before_, motion_};
    const double overlap = AddOverlapLimits(tool_, X, X, 0.0, candidates, -1, limits);
    EXPECT_NEAR(overlap, tool_.shaft_radius - gap, 1e-6);
    for (const ProxyLimit& limit : limits.limits)
      EXPECT_LT(limit.normal.x, -0.9) << "the rim is on the right";
  }
}

class Tools : public testing::Test {
 protected:
  static constexpr Vec3 kLeftPort{-0.1, 0, 0.15}, kRightPort{0.1, 0, 0.15};
  /// Left: at rest. Right: from one place of its tip to another in one tick.
  ToolsContact Move(const Vec3& left_tip, const Vec3& right_from, const Vec3& right_to) {
    const auto pose = [](const Vec3& port, const Vec3& tip) {
      return instrument::CalcToolPose(port, instrument::FindJoints(port, tip, 0, 0));
    };
    const Pose left = pose(kLeftPort, left_tip), from = pose(kRightPort, right_from);
    motions_ = {ToolMotion{&tool_, 0, left, left, left, 0, 0, -1},
                ToolMotion{&tool_, 1, from, from, pose(kRightPort, right_to), 0, 0, -1}};
    for (auto& limits : limits_) limits.limits.clear();
    return FindToolsContact(motions_, limits_);
  }
  instrument::Tool tool_;
  std::array<ToolMotion, 2> motions_;
  std::array<ProxyLimits, 2> limits_;
};

TEST_F(Tools, ApartTheyFeelNothing) {
  const ToolsContact contact = Move({0, 0, 0}, {0.05, 0.02, 0}, {0.04, 0.02, 0});
  EXPECT_FALSE(contact.is_touching);
  EXPECT_EQ(math::Norm(contact.force[0]), 0.0);
}

TEST_F(Tools, CrossedShaftsPushEachOtherApart) {
  const ToolsContact contact = Move({0.02, 0, 0}, {-0.02, 0.02, 0}, {-0.02, 0.004, 0});
  ASSERT_TRUE(contact.is_touching);
  EXPECT_GT(contact.force[1].y, 0.1) << "the right tool came from +y and is held back";
  EXPECT_EQ(math::Norm(contact.force[0] + contact.force[1]), 0.0) << "action and reaction";
}

TEST_F(Tools, DoNotPassThroughEachOtherBetweenTwoTicks) {
  const ToolsContact contact = Move({0.02, 0, 0}, {-0.02, 0.012, 0}, {-0.02, -0.012, 0});
  ASSERT_TRUE(contact.is_touching);
  EXPECT_GT(contact.force[1].y, 1.0);
  ASSERT_FALSE(limits_[1].limits.empty());
  // with half of the way each, the proxies do not overlap
  const Vec3* ports[2] = {&kLeftPort, &kRightPort};
  const Vec3 tips[2] = {{0.02, 0, 0}, {-0.02, -0.012, 0}};
  std::array<std::array<collision::Capsule, 3>, 2> bodies;
  for (int hand = 0; hand < 2; ++hand) {
    const auto proxy = FindProxy({*ports[hand], instrument::FindJoints(*ports[hand], tips[hand], 0, 0)}, {},
                                 limits_[hand].limits);
    bodies[hand] = CalcToolBodies(tool_, 0, instrument::CalcToolPose(*ports[hand], proxy));
  }
  for (const auto& a : bodies[0]) {
    for (const auto& b : bodies[1]) EXPECT_GT(collision::FindCapsuleGap(a, b).distance, -5e-4);
  }
}

}  // namespace
}  // namespace trocar::surgery
