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
  std::vector<view::Trail> Guides() const {
    return MakeGuides(*scene, simulation.Surfaces(), simulation.Strands(), snapshot);
  }
};

int CountMarks(const std::vector<view::Trail>& trails) {
  return static_cast<int>(std::count_if(trails.begin(), trails.end(), [](const view::Trail& trail) {
    return trail.material == render::Material::kMark;
  }));
}

TEST(Guides, DropFromTheTipToTheBoard) {
  Bench bench = Bench::OfTask("peg_transfer");
  const Vec3 tip{0.004, 0.02, -0.100};
  const auto distance = FindDistanceAhead(*bench.scene, bench.simulation.Surfaces(),
                                          bench.simulation.Strands(), bench.snapshot, tip, {0, 0, -1});
  ASSERT_TRUE(distance.has_value());
  EXPECT_NEAR(*distance, tip.z - kBoardTop, 1e-9);
  EXPECT_FALSE(FindDistanceAhead(*bench.scene, {}, {}, bench.snapshot, tip, {0, 0, 1}).has_value())
      << "upwards";
  EXPECT_FALSE(
      FindDistanceAhead(*bench.scene, {}, {}, bench.snapshot, {0.4, 0, -0.1}, {0, 0, -1}).has_value())
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

// The issue: rings in the box were ignored.
TEST(Guides, MeetTheRimOfARingAndNotItsHole) {
  const Bench bench = Bench::OfTask("peg_transfer");
  const math::Pose& X = bench.snapshot.objects[0].X_world_object;
  const auto& shapes = bench.scene->objects[0].body.shapes;
  double radius = 0, section = 0;
  for (const rigid::RigidShape& shape : shapes) {
    if (shape.kind == rigid::RigidShape::Kind::kRing) radius = shape.size.x, section = shape.size.y;
  }
  ASSERT_GT(radius, 0);
  const auto surfaces = bench.simulation.Surfaces();
  const auto strands = bench.simulation.Strands();
  const Vec3 above = X * Vec3{radius, 0, 0} + Vec3{0, 0, 0.03};
  const auto rim = FindDistanceAhead(*bench.scene, surfaces, strands, bench.snapshot, above, {0, 0, -1});
  ASSERT_TRUE(rim.has_value());
  EXPECT_NEAR(*rim, 0.03 - section, 5e-4);
  Bench held = Bench::OfTask("peg_transfer");
  held.snapshot.objects[0].held_by = 1;
  const auto below = FindDistanceAhead(*held.scene, surfaces, strands, held.snapshot, above, {0, 0, -1});
  ASSERT_TRUE(below.has_value());
  EXPECT_GT(*below, *rim + section) << "what the jaws hold goes with them";
}

// The issue: the fat and fibres of the triangle were ignored.
TEST(Guides, MeetFibresUntilTheyAreDivided) {
  Bench bench = Bench::OfTask("hook_dissection");
  const auto strands = bench.simulation.Strands();
  ASSERT_FALSE(strands.empty());
  const Vec3 &a = bench.snapshot.positions[strands[0].a], &b = bench.snapshot.positions[strands[0].b];
  const Vec3 middle = math::Lerp(a, b, 0.5);
  const Vec3 across = math::Normalized(math::Cross(b - a, Vec3{0.3, 0.5, 0.8}));
  const Vec3 from = middle + 0.02 * across;
  const auto met = FindDistanceAhead(*bench.scene, {}, strands.first(1), bench.snapshot, from, -1.0 * across);
  ASSERT_TRUE(met.has_value());
  EXPECT_NEAR(*met, 0.02, 0.002);
  bench.snapshot.operation.strand_is_intact.assign(strands.size(), 0);
  const auto behind =
      FindDistanceAhead(*bench.scene, {}, strands.first(1), bench.snapshot, from, -1.0 * across);
  EXPECT_TRUE(!behind || *behind > *met + 0.002) << "what lies behind it";
}

TEST(Guides, MeetTissueWhereTheWheelLeads) {
  const auto read = files::ReadScene(std::string(TROCAR_SOURCE_DIR) + "/scenes/demonstration.json");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const Bench bench = Bench::Make(*read);
  // down the laparoscope's axis there is an organ: the answer is the nearest vertex' distance, to a triangle's size
  const math::Pose& X = bench.snapshot.X_world_laparoscope;
  const Vec3 way = math::Rotate(X.rotation, Vec3{0, 0, -1});
  const auto distance = FindDistanceAhead(*bench.scene, bench.simulation.Surfaces(),
                                          bench.simulation.Strands(), bench.snapshot, X.translation, way);
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
