// SPDX-License-Identifier: Apache-2.0
// Stones: how many, through which hole, where they come to lie, and how they are taken.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "bad_tick.h"
#include "operation/operated_anatomy.h"
#include "operation_harness.h"
#include "trocar/geometry/primitives.h"
#include "trocar/patient/patient.h"
#include "trocar/surgery/wall_holes.h"

namespace trocar::simulation {

using instrument::kLeft;
using instrument::kRight;
using math::Pose;
using math::Vec3;
using scene::Scene;
using surgery::FactKind;
using surgery::StonePlace;
using surgery::StoneSnapshot;

namespace {

using surgery::LooseStone;

Scene WithStones(int count, double diameter) {
  Scene scene = *OperationScene();
  scene.operation->gallstones = {count, diameter};
  return scene;
}

patient::Parameter Number(const char* name, double value) {
  return {name, value, "", "set by the user"};
}

TEST(FindGallstones, AreThePatientsElseTheScenes) {
  Scene scene = WithStones(9, 0.004);
  EXPECT_EQ(FindGallstones(scene).count, 9);
  EXPECT_DOUBLE_EQ(FindGallstones(scene).median_diameter, 0.004);
  scene.patient.parameters = {Number("gallstone_count", 3.0), Number("gallstone_diameter", 12.0)};
  EXPECT_EQ(FindGallstones(scene).count, 3);
  EXPECT_DOUBLE_EQ(FindGallstones(scene).median_diameter, 0.012);
  scene.patient.parameters = {Number("gallstone_count", 0.0)};
  EXPECT_EQ(FindGallstones(scene).count, 0);
  scene.patient.parameters = {Number("gallstone_count", 1e9), Number("gallstone_diameter", -4.0)};
  EXPECT_EQ(FindGallstones(scene).count, surgery::kMostGallstones);
  EXPECT_DOUBLE_EQ(FindGallstones(scene).median_diameter, 0.001);
}

/// A ball of 15 mm as organ.
struct BallOrgan {
  geometry::TriangleMesh mesh = geometry::MakeSphere({}, 0.015, 3);
  surgery::OrganSurface surface = std::move(*surgery::MakeOrganSurface(mesh.positions, 0, mesh));
  geometry::EditableMesh editable = std::move(*geometry::EditableMesh::Make(mesh, 64, 256));
};

TEST(WallHoles, NodesSideBySideMakeOneHole) {
  const BallOrgan ball;
  surgery::WallHoles holes;
  const auto find = [&] { return holes.FindLargest(ball.surface, ball.mesh.positions, ball.editable); };
  EXPECT_EQ(find().rim, 0.0) << "a whole wall";
  const geometry::Triangle& t = ball.mesh.triangles[100];
  holes.Add(t[0], 0.004);
  EXPECT_DOUBLE_EQ(find().rim, 0.004);
  EXPECT_NEAR(math::Distance(find().position, ball.mesh.positions[t[0]]), 0.0, 1e-12);
  EXPECT_GT(math::Dot(find().outwards, math::Normalized(ball.mesh.positions[t[0]])), 0.99);
  // one far away is another hole, a neighbour widens the first
  const auto far =
      static_cast<std::uint32_t>(std::max_element(ball.mesh.positions.begin(), ball.mesh.positions.end(),
                                                  [&](const Vec3& a, const Vec3& b) {
                                                    return math::Distance(a, ball.mesh.positions[t[0]]) <
                                                           math::Distance(b, ball.mesh.positions[t[0]]);
                                                  }) -
                                 ball.mesh.positions.begin());
  holes.Add(far, 0.003);
  EXPECT_DOUBLE_EQ(find().rim, 0.004);
  holes.Add(t[1], 0.004);
  const double apart = math::Distance(ball.mesh.positions[t[0]], ball.mesh.positions[t[1]]);
  EXPECT_NEAR(find().rim, 0.004 + 2 * apart, 1e-12);
  holes.Add(t[2], 0.004);
  EXPECT_GE(find().rim, 0.004 + 2 * apart);
  // more than its capacity
  for (std::uint32_t i = 0; i < ball.mesh.positions.size(); ++i) holes.Add(i, 0.001);
  EXPECT_TRUE(std::isfinite(find().rim));
}

/// Stones of the built-in patient, and the organs as they lie at rest.
class GallstoneSpillTest : public OperationHarness {
 protected:
  void MakeStones(int count, double diameter) {
    const Scene scene = WithStones(count, diameter);
    auto made = MakeGallstones(scene, Tissue().surfaces, Tissue().definition.rest);
    ASSERT_TRUE(made.ok()) << made.error().Text();
    stones_ = std::move(*made);
  }

  /// Beside the gallbladder's body, on its free side.
  surgery::WallHole Hole(double rim) const {
    const scene::SurfaceInfo& wall = Gallbladder();
    const Vec3 body = OperationScene()->patient.FindLandmark("gallbladder_body")->position;
    surgery::WallHole hole;
    hole.rim = rim;
    double nearest = 1;
    for (std::uint32_t i = 0; i < wall.node_count; ++i) {
      const Vec3& p = Position()[wall.first_node + i];
      if (math::Distance(p, body) < nearest) nearest = math::Distance(p, body), hole.position = p;
    }
    hole.outwards = math::Normalized(Vec3{0.82, -0.55, -0.18});
    return hole;
  }

  void Fall(double seconds, std::span<const Pose> tools = {}) {
    surgery::StoneGround ground;
    ground.organs = Organs();
    ground.positions = Position();
    ground.gravity = kGravity;
    ground.deepest = -0.3;
    const std::array<Pose, instrument::kHandCount> none{};
    for (double t = 0; t < seconds; t += kTick)
      stones_.Move(ground, tools.empty() ? std::span<const Pose>(none) : tools, {}, kTick);
  }

  std::vector<StoneSnapshot> Seen() const {
    std::vector<StoneSnapshot> stones(stones_.Size());
    stones_.Publish(stones);
    return stones;
  }
  /// The first that lies in the abdomen.
  StoneSnapshot Spilled() const {
    for (const StoneSnapshot& stone : Seen()) {
      if (stone.place == StonePlace::kSpilled) return stone;
    }
    ADD_FAILURE() << "none has been spilled";
    return {};
  }

  surgery::GallstoneSpill stones_;
};

TEST_F(GallstoneSpillTest, OnlyWhatFitsLeavesAndOnlyAsFastAsTheBile) {
  MakeStones(30, 0.004);
  const double content = 30e-6, rim = M_PI * 0.004;
  int fitting = 0;
  for (const StoneSnapshot& stone : Seen()) fitting += 2 * stone.radius <= 0.004 ? 1 : 0;
  ASSERT_GT(fitting, 5);
  ASSERT_LT(fitting, 25);
  EXPECT_EQ(stones_.Spill(0.0, content, Hole(rim)), 0) << "no bile, no stone";
  EXPECT_EQ(stones_.Spill(10e-6, content, Hole(1e-4)), 0) << "a pinhole";
  const int third = stones_.Spill(10e-6, content, Hole(rim));
  EXPECT_NEAR(third, fitting / 3.0, 1.0);
  int spilled = third;
  for (double left = 20e-6; left > 1e-9; left -= 1e-8) spilled += stones_.Spill(1e-8, left, Hole(rim));
  EXPECT_NEAR(spilled, fitting, 1) << "with the last drop the last of them";
  for (const StoneSnapshot& stone : Seen())
    EXPECT_TRUE(stone.place == StonePlace::kInside || 2 * stone.radius <= 0.004);
  EXPECT_EQ(stones_.Count().spilled, spilled);
  EXPECT_EQ(stones_.Count().inside + spilled, stones_.Count().all);
  stones_.Reset();
  EXPECT_EQ(stones_.Count().inside, stones_.Count().all);
}

TEST_F(GallstoneSpillTest, FallOntoWhatLiesBelowAndLieStill) {
  MakeStones(12, 0.003);
  ASSERT_GT(stones_.Spill(30e-6, 30e-6, Hole(0.05)), 10);
  Fall(4.0);
  const auto before = Seen();
  Fall(0.5);
  const auto after = Seen();
  int still = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    still += before[i].position == after[i].position ? 1 : 0;
    EXPECT_LT(math::Distance(before[i].position, Hole(0.05).position), 0.12) << "in the field";
    for (const surgery::OrganSurface& organ : Organs()) {
      const auto nearest = organ.tree.FindNearest(organ.Nodes(Position()), after[i].position);
      EXPECT_GT(std::sqrt(nearest.squared_distance), 0.8 * after[i].radius) << "stone " << i;
    }
  }
  EXPECT_GE(still, 9) << "what other stones hold up may creep";
}

TEST_F(GallstoneSpillTest, SmallOnesAreSuckedUp) {
  MakeStones(20, 0.0036);
  const int out = stones_.Spill(30e-6, 30e-6, Hole(0.05));
  Fall(3.0);
  const double bore = 0.0036;
  EXPECT_EQ(stones_.Aspirate(Spilled().position + Vec3{0, 0, 0.02}, bore), 0) << "too far";
  int sucked = 0, wide = 0;
  for (const StoneSnapshot& stone : Seen()) {
    sucked += stones_.Aspirate(stone.position, bore);
    wide += 2 * stone.radius > bore ? 1 : 0;
  }
  EXPECT_GT(sucked, 3);
  EXPECT_EQ(sucked, stones_.Count().aspirated);
  EXPECT_EQ(stones_.Count().spilled, out - sucked);
  EXPECT_EQ(stones_.Count().spilled, wide) << "what does not pass the bore stays";
}

TEST_F(GallstoneSpillTest, JawsTakeOneStopAtItAndLetGo) {
  MakeStones(1, 0.004);
  ASSERT_EQ(stones_.Spill(30e-6, 30e-6, Hole(0.05)), 1);
  Fall(3.0);
  const instrument::Tool& grasper = *instrument::FindTool("grasper");
  const StoneSnapshot stone = Spilled();
  // from above, the stone 8 mm behind the tips
  const Pose X{{}, stone.position - Vec3{0, 0, 0.008}};
  double jaw = grasper.max_jaw;
  const auto close = [&](double to, bool can_take = true) {
    while (jaw > to) {
      const double before = jaw, next = stones_.StopJaw(kLeft, grasper, X, before, jaw - 0.02, can_take);
      jaw = next;
      if (next >= before) break;
    }
  };
  close(0.1, false);
  EXPECT_EQ(stones_.HeldBy(kLeft), -1) << "jaws that hold tissue take no stone";
  jaw = grasper.max_jaw;
  close(0.0);
  ASSERT_EQ(stones_.HeldBy(kLeft), 0);
  EXPECT_TRUE(stones_.HasTaken(kLeft));
  EXPECT_FALSE(stones_.HasTaken(kLeft)) << "emitted once";
  EXPECT_NEAR(jaw, 2 * std::asin(stone.radius / (grasper.jaw_length - 0.008)), 0.01) << "it keeps them apart";
  EXPECT_EQ(stones_.Count().spilled, 1) << "still in the abdomen";
  // lifted, and let go
  const std::array<Pose, instrument::kHandCount> lifted{Pose{{}, X.translation + Vec3{0, 0, 0.03}}, Pose{}};
  Fall(kTick, lifted);
  EXPECT_NEAR(Seen()[0].position.z, stone.position.z + 0.03, 1e-6);
  EXPECT_EQ(Seen()[0].hand, kLeft);
  (void)stones_.StopJaw(kLeft, grasper, lifted[0], jaw, 0.9 * grasper.max_jaw, true);
  EXPECT_EQ(stones_.HeldBy(kLeft), -1);
  Fall(2.0);
  EXPECT_LT(Seen()[0].position.z, stone.position.z + 0.01) << "it has fallen";
}

TEST_F(GallstoneSpillTest, WhatIsLetGoOverTheBagIsInIt) {
  MakeStones(2, 0.004);
  ASSERT_EQ(stones_.Spill(30e-6, 30e-6, Hole(0.05)), 2);
  // the mouth lies ahead of the tip, the pouch hangs towards -y: here downwards
  const math::Quaternion turn = math::RotationAbout({1, 0, 0}, 0.5 * M_PI);
  const Vec3 ahead = math::Rotate(turn, {0, 0, -0.5 * instrument::kBagMouth});
  const Vec3 out = Seen()[0].position;
  EXPECT_EQ(stones_.CatchInBag({turn, out - ahead + Vec3{0.05, 0, 0.01}}), 0) << "beside it";
  EXPECT_EQ(stones_.CatchInBag({turn, out - ahead + Vec3{0, 0, 0.01}}), 2);
  EXPECT_EQ(stones_.Count().in_bag, 2);
  EXPECT_EQ(stones_.Count().spilled, 0);
}

// --- the whole of it, without a solver between

class SpillTest : public OperationHarness {
 protected:
  /// Opens the wall at a spring and lets bile out.
  void Spill(double volume) {
    tissue::OrganVolume& organ = conserved_.organs[static_cast<std::size_t>(gallbladder_)];
    torn_ = {FreeWallSpring()};
    Judge();
    torn_.clear();
    organ.target -= volume;
    organ.leaked += volume;
    Judge();
  }
};

TEST_F(SpillTest, ATornWallSpillsStonesThatAreToldAndCounted) {
  MakeOperation();
  Judge();
  EXPECT_EQ(Result().stones.spilled, 0);
  int emitted = 0;
  Spill(15e-6);
  for (const surgery::Fact& fact : facts_.All()) emitted += fact.kind == FactKind::kStoneSpilled ? 1 : 0;
  const OperationResult result = Result();
  ASSERT_GT(result.stones.spilled, 1);
  EXPECT_EQ(emitted, result.stones.spilled);
  EXPECT_EQ(result.stones.inside + result.stones.spilled, result.stones.all);
  EXPECT_NEAR(result.fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].left, 15e-6, 1e-12);
}

// Bile that has run out is counted once, however often the tick after it goes wrong.
TEST_F(SpillTest, ATickThatIsTakenBackGivesNoBileBack) {
  MakeOperation();
  Judge();
  const tissue::ConservationTick good = conserved_;
  tissue::OrganVolume& organ = conserved_.organs[static_cast<std::size_t>(gallbladder_)];
  const double before = organ.target;
  Spill(15e-6);
  for (int bad = 0; bad < 3; ++bad) {
    TakeBack(good, conserved_);
    ASSERT_EQ(organ.leaked, 0.0) << "the control: the guard has given it back";
    Judge();
  }
  organ.target -= 1e-6, organ.leaked += 1e-6;
  Judge();
  EXPECT_NEAR(Result().fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].left, 16e-6, 1e-12);
  EXPECT_NEAR(organ.leaked, 16e-6, 1e-12);
  EXPECT_NEAR(organ.target, before - 16e-6, 1e-12);
}

TEST_F(SpillTest, TheHashFollowsThem) {
  const auto hash = [&] {
    base::StateHash value;
    base::AddStateTo(value, *operation_);
    return value.Value();
  };
  MakeOperation();
  const std::uint64_t start = hash();
  Spill(15e-6);
  const std::uint64_t spilled = hash();
  EXPECT_NE(spilled, start);
  Judge();
  EXPECT_NE(hash(), spilled) << "they fall";
  MakeOperation();
  EXPECT_EQ(hash(), start);
  Spill(15e-6);
  EXPECT_EQ(hash(), spilled);
}

TEST_F(SpillTest, WhatIsNotRetrievedIsAnErrorWhenTheBagIsOut) {
  for (const bool retrieves : {false, true}) {
    MakeOperation();
    Spill(15e-6);
    for (int i = 0; i < 240; ++i) Judge();
    if (retrieves) {
      // the sucker goes from stone to stone; those of 3 mm and less pass its bore
      SelectTool(kRight, instrument::ToolKind::kSuctionIrrigator);
      input_.controls[kRight].aspirate = true;
      for (int round = 0; round < 3; ++round) {
        for (const StoneSnapshot& stone : Published().stones) {
          if (stone.place != StonePlace::kSpilled) continue;
          hands_.X_proxy[kRight] = hands_.X_device[kRight] = {{}, stone.position};
          Act();
          Judge();
        }
      }
      input_.controls[kRight].aspirate = false;
      ASSERT_EQ(Result().stones.spilled, 0);
    }
    TakeGallbladderOut();
    const OperationResult result = Result();
    ASSERT_TRUE(result.is_completed);
    const std::size_t errors = CountErrors("stones_left");
    EXPECT_EQ(errors, retrieves ? 0u : 1u);
    EXPECT_EQ(result.stones.spilled == 0, retrieves);
  }
}

// Pictures show water and suction while a pedal is down; no state knows of it, so that hashes stay what they were.
TEST_F(SpillTest, PedalsOfTheIrrigatorArePublishedAndInNoState) {
  const auto hash = [&] {
    base::StateHash value;
    base::AddStateTo(value, *operation_);
    return value.Value();
  };
  MakeOperation();
  SelectTool(kRight, instrument::ToolKind::kSuctionIrrigator);
  Act();
  const std::uint64_t before = hash();
  EXPECT_FALSE(Published().is_rinsing[kRight]);
  input_.controls[kRight].aspirate = true;  // far from any pool: it changes nothing
  hands_.X_proxy[kRight] = hands_.X_device[kRight] = {{}, {0.4, 0.4, 0.4}};
  Act();
  EXPECT_TRUE(Published().is_aspirating[kRight]);
  EXPECT_FALSE(Published().is_rinsing[kRight]);
  EXPECT_FALSE(Published().is_aspirating[kLeft]);
  EXPECT_EQ(hash(), before);
  input_.controls[kRight].aspirate = false;
  input_.controls[kRight].rinse = true;
  Act();
  EXPECT_TRUE(Published().is_rinsing[kRight]);
  EXPECT_FALSE(Published().is_aspirating[kRight]);
  // of another tool the pedal means nothing
  SelectTool(kRight, instrument::ToolKind::kHook);
  Act();
  EXPECT_FALSE(Published().is_rinsing[kRight]);
  input_.controls[kRight] = {};
}

TEST_F(SpillTest, AStoneGoesOutWithTheToolThatHoldsIt) {
  MakeOperation();
  Spill(15e-6);
  for (int i = 0; i < 240; ++i) Judge();
  SelectTool(kRight, instrument::ToolKind::kGrasper);
  const auto stones = Published().stones;
  const auto stone = std::find_if(stones.begin(), stones.end(),
                                  [](const StoneSnapshot& s) { return s.place == StonePlace::kSpilled; });
  ASSERT_NE(stone, stones.end());
  hands_.X_proxy[kRight] = hands_.X_device[kRight] = {{}, stone->position - Vec3{0, 0, 0.006}};
  Judge();
  const double most = operation_->Tool(kRight).max_jaw;
  double jaw = 0.5 * most;
  for (int i = 0; i < 60; ++i) {
    const double next = operation_->StopJaw(kRight, jaw, std::max(0.0, jaw - 0.02), false);
    if (next == jaw) break;
    jaw = next;
  }
  ASSERT_TRUE(operation_->HoldsStone(kRight));
  Judge();
  bool was_told = false;
  for (const surgery::Fact& fact : facts_.All()) was_told |= fact.kind == FactKind::kStoneTaken;
  EXPECT_TRUE(was_told);
  const int before = Result().stones.spilled;
  SelectTool(kRight, instrument::ToolKind::kHook);
  EXPECT_EQ(Result().stones.taken_out, 1);
  EXPECT_EQ(Result().stones.spilled, before - 1);
  EXPECT_FALSE(operation_->HoldsStone(kRight));
}

// --- in the tick: the hook on the free wall, current until it gives way

TEST(Spilling, TheHookPerforatesAndStonesComeOutWithTheBile) {
  auto scene = std::make_shared<Scene>(WithStones(40, 0.002));
  auto made = Simulation::Make(scene);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  Simulation& simulation = *made;
  const Snapshot& seen = simulation.GetSnapshot();
  const scene::SurfaceInfo& wall =
      simulation.Surfaces()[static_cast<std::size_t>(scene->patient.FindOrgan("gallbladder"))];
  const Vec3 body = scene->patient.FindLandmark("gallbladder_body")->position;
  std::uint32_t node = wall.first_node;
  for (std::uint32_t i = 0; i < wall.node_count; ++i) {
    if (math::Distance(seen.positions[wall.first_node + i], body) <
        math::Distance(seen.positions[node], body))
      node = wall.first_node + i;
  }
  const Vec3 outwards{0.82, -0.55, -0.18};
  scene::Input input = scene::CalcScriptInput(*scene, 0.0);
  std::uint64_t known = 0;
  int emitted = 0;
  for (int tick = 0; tick < 120 * 12; ++tick) {
    // pressed on until it gives: it moves off, and the wire may come to lie beside it
    const double away = tick < 180 ? 0.02 * (1.0 - tick / 180.0) : -0.002 - 0.001 * (tick - 180) / 120.0;
    input.hands[kRight] = instrument::FindJoints(scene->instruments[kRight].p_world_port,
                                                 seen.positions[node] + away * outwards, 0.0, 0.0);
    input.controls[kRight].coagulate = tick >= 180;
    simulation.Step(input);
    for (; known < seen.event_count; ++known)
      emitted += seen.events[known % seen.events.size()].kind == FactKind::kStoneSpilled ? 1 : 0;
    if (emitted >= 2) break;
  }
  const OperationResult result = *simulation.GetOperationResult();
  EXPECT_GE(result.stones.spilled, 2);
  EXPECT_EQ(result.stones.spilled, emitted);
  EXPECT_GT(result.procedure.errors.Count(
                *scene::FindError(*scene->operation->procedure, "gallbladder_perforated")),
            0u);
  // no more than their share of the bile
  const OrganSnapshot& bile = seen.organs[static_cast<std::size_t>(scene->patient.FindOrgan("gallbladder"))];
  EXPECT_LE(result.stones.spilled, 1 + 40 * bile.leaked / (bile.leaked + bile.target) * 1.6);
  simulation.Reset();
  EXPECT_EQ(simulation.GetOperationResult()->stones.spilled, 0);
}

}  // namespace
}  // namespace trocar::simulation
