// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/guides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/simulation/simulation.h"

namespace trocar::presenter {
namespace {

using math::Vec3;

constexpr double kBoardTop = -0.140;  // of peg transfer [m]

struct Bench {
  std::shared_ptr<const scene::Scene> scene;
  simulation::Simulation simulation;
  simulation::Snapshot snapshot;  // to be changed by a test

  static Bench Make(const scene::Scene& read) {
    auto scene = std::make_shared<const scene::Scene>(read);
    auto simulation = simulation::Simulation::Make(scene);
    EXPECT_TRUE(simulation.ok()) << simulation.error().Text();
    simulation::Snapshot snapshot = simulation->GetSnapshot();
    return {scene, std::move(simulation).value(), std::move(snapshot)};
  }
  static Bench OfTask(const char* task) {
    auto read = files::ReadTask(*files::FindTask(task));
    EXPECT_TRUE(read.ok()) << read.error().Text();
    return Make(*read);
  }
  std::vector<view::Trail> Guides() const { return MakeGuides(*scene, simulation.Surfaces(), snapshot); }
};

int CountMarks(const std::vector<view::Trail>& trails) {
  return static_cast<int>(std::count_if(trails.begin(), trails.end(), [](const view::Trail& trail) {
    return trail.material == render::Material::kMark;
  }));
}

TEST(Guides, DropFromTheTipToTheBoard) {
  Bench bench = Bench::OfTask("peg_transfer");
  const Vec3 tip{0.004, 0.02, -0.100};
  const auto distance =
      FindDistanceAhead(*bench.scene, bench.simulation.Surfaces(), bench.snapshot, tip, {0, 0, -1});
  ASSERT_TRUE(distance.has_value());
  EXPECT_NEAR(*distance, tip.z - kBoardTop, 1e-9);
  EXPECT_FALSE(FindDistanceAhead(*bench.scene, {}, bench.snapshot, tip, {0, 0, 1}).has_value()) << "upwards";
  EXPECT_FALSE(FindDistanceAhead(*bench.scene, {}, bench.snapshot, {0.4, 0, -0.1}, {0, 0, -1}).has_value())
      << "beside the board";
  // the lowest point of a hand's line lies on the board, below the tip
  bench.snapshot.instruments[instrument::kLeft].X_world_tool.translation = tip;
  const auto trails = bench.Guides();
  double lowest = 0;
  for (const view::Trail& trail : trails) {
    if (trail.material != render::Material::kBlueRubber) continue;
    for (const Vec3& p : trail.points) {
      lowest = std::min(lowest, p.z);
      EXPECT_LT(std::hypot(p.x - tip.x, p.y - tip.y), 0.004);
    }
  }
  EXPECT_NEAR(lowest, kBoardTop, 0.001);
}

TEST(Guides, MeetTissueWhereTheWheelLeads) {
  const auto read = files::ReadScene(std::string(TROCAR_SOURCE_DIR) + "/scenes/demonstration.json");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const Bench bench = Bench::Make(*read);
  // down the laparoscope's axis there is an organ: the answer is the nearest vertex' distance, to a triangle's size
  const math::Pose& X = bench.snapshot.X_world_laparoscope;
  const Vec3 way = math::Rotate(X.rotation, Vec3{0, 0, -1});
  const auto distance =
      FindDistanceAhead(*bench.scene, bench.simulation.Surfaces(), bench.snapshot, X.translation, way);
  ASSERT_TRUE(distance.has_value());
  const Vec3 met = X.translation + *distance * way;
  double nearest = 1;
  for (const Vec3& p : bench.snapshot.positions) nearest = std::min(nearest, math::Distance(p, met));
  EXPECT_LT(nearest, 0.008);
}

TEST(Guides, MarkTheNextRingAndThenItsFreePegs) {
  Bench bench = Bench::OfTask("peg_transfer");
  const NextStep first = FindNextStep(*bench.scene->task, bench.snapshot);
  EXPECT_EQ(first.object, 0);
  EXPECT_TRUE(first.regions.empty()) << "it has to be taken first";
  EXPECT_EQ(CountMarks(bench.Guides()), 1);

  bench.snapshot.objects[0].held_by = 1;
  EXPECT_EQ(FindNextStep(*bench.scene->task, bench.snapshot).regions.size(), 6u);
  EXPECT_EQ(CountMarks(bench.Guides()), 7);

  bench.snapshot.objects[1].X_world_object.translation = {0.031, 0.002, -0.1375};  // on a peg of the right
  EXPECT_EQ(FindNextStep(*bench.scene->task, bench.snapshot).regions.size(), 5u);

  bench.snapshot.task.phase = scene::TaskPhase::kCompleted;
  EXPECT_EQ(FindNextStep(*bench.scene->task, bench.snapshot).object, -1);
}

TEST(Guides, SayWhetherJawsAreOpenClosedOrHold) {
  Bench bench = Bench::OfTask("peg_transfer");
  auto& left = bench.snapshot.instruments[instrument::kLeft];
  left.joints.jaw = 0;
  EXPECT_EQ(DescribeJaws(*bench.scene, bench.snapshot, instrument::kLeft), "closed");
  left.joints.jaw = 0.8;
  EXPECT_EQ(DescribeJaws(*bench.scene, bench.snapshot, instrument::kLeft), "open");
  const std::size_t before = bench.Guides().size();
  left.is_grasping = true;
  left.object = 2;
  EXPECT_EQ(DescribeJaws(*bench.scene, bench.snapshot, instrument::kLeft), "holds ring 3");
  EXPECT_EQ(bench.Guides().size(), before + 1) << "a ring round jaws that hold";
}

}  // namespace
}  // namespace trocar::presenter
