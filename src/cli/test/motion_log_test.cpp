// SPDX-License-Identifier: Apache-2.0
#include "motion_log.h"

#include <gtest/gtest.h>

#include "trocar/training/motion_metrics.h"

namespace trocar::cli {
namespace {

using math::Pose;
using scene::EventKind;

// The laparoscope looks along -z.
TEST(IsInView, IsAConeInFrontOfTheLens) {
  const double fov = 1.2;
  EXPECT_TRUE(simulation::IsInView({}, fov, {0, 0, -0.1}));
  EXPECT_FALSE(simulation::IsInView({}, fov, {0, 0, 0.1}));
  EXPECT_FALSE(simulation::IsInView({}, fov, {0, 0, 0}));
  EXPECT_TRUE(simulation::IsInView({}, fov, {0.1 * std::tan(0.59), 0, -0.1}));
  EXPECT_FALSE(simulation::IsInView({}, fov, {0, 0.1 * std::tan(0.61), -0.1}));
  // moved and turned to look along +x
  const Pose X_world_laparoscope{math::RotationAbout({0, 1, 0}, -M_PI / 2), {1, 2, 3}};
  EXPECT_TRUE(simulation::IsInView(X_world_laparoscope, fov, {1.1, 2, 3}));
  EXPECT_FALSE(simulation::IsInView(X_world_laparoscope, fov, {0.9, 2, 3}));
}

class Log : public testing::Test {
 protected:
  void Add(EventKind kind, int hand) {
    snapshot_.events[snapshot_.event_count % snapshot_.events.size()] = {kind, snapshot_.tick, hand, 0, 0.0};
    ++snapshot_.event_count;
  }
  void Tick() {
    ++snapshot_.tick;
    snapshot_.time = static_cast<double>(snapshot_.tick) * scene_.tick_seconds;
    log_.Record(snapshot_);
  }

  scene::Scene scene_;
  MotionLog log_{scene_, 10};
  simulation::Snapshot snapshot_;
};

TEST_F(Log, TakesOverPoseForceAndState) {
  auto& right = snapshot_.instruments[scene::kRight];
  right.X_world_tool.translation = {0.01, 0.02, -0.1};
  right.force = {0, 3, 4};
  right.joints.depth = 0.12;
  right.is_grasping = true;
  right.is_touching = true;
  Tick();
  const auto& sample = log_.Recording().tools[scene::kRight].front();
  EXPECT_EQ(sample.tip, (math::Vec3{0.01, 0.02, -0.1}));
  EXPECT_DOUBLE_EQ(sample.force, 5.0);
  EXPECT_DOUBLE_EQ(sample.insertion, 0.12);
  EXPECT_DOUBLE_EQ(sample.axis.z, -1.0);
  EXPECT_TRUE(sample.grasping);
  EXPECT_TRUE(sample.in_contact);
  EXPECT_TRUE(sample.in_view);
  EXPECT_EQ(log_.Times().size(), 1u);
}

TEST_F(Log, CountsEveryEventOnce) {
  Add(EventKind::kGrasp, scene::kLeft);
  Tick();
  Tick();
  Add(EventKind::kSlip, scene::kLeft);
  Add(EventKind::kGraspMissed, scene::kRight);
  Add(EventKind::kStateRestored, -1);
  Tick();
  for (int i = 0; i < 20; ++i) {
    Add(EventKind::kGrasp, scene::kRight);
    Tick();
  }
  const auto metrics = training::CalcSessionMetrics(log_.Recording());
  ASSERT_TRUE(metrics.ok());
  EXPECT_EQ(metrics->tools[scene::kLeft].grasp_attempts, 1);
  EXPECT_EQ(metrics->tools[scene::kLeft].grasp_successes, 1);
  EXPECT_EQ(metrics->tools[scene::kLeft].grasp_slips, 1);
  EXPECT_EQ(metrics->tools[scene::kRight].grasp_attempts, 21);
  EXPECT_EQ(metrics->tools[scene::kRight].grasp_successes, 20);
}

}  // namespace
}  // namespace trocar::cli
