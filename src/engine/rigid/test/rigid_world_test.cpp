// SPDX-License-Identifier: Apache-2.0
#include "trocar/rigid/rigid_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "trocar/base/state_hash.h"

namespace trocar::rigid {

using math::Pose;
using math::Vec3;

namespace {

using Kind = RigidShape::Kind;
constexpr double kTick = 1.0 / 120;
constexpr Vec3 kDown{0, 0, -9.81};

RigidBody MakeFloor() {
  return {{{Kind::kBox, {0.2, 0.2, 0.01}, {}}}, {{}, {0, 0, -0.01}}, 0, 1.0};
}

RigidBody MakeCube(const Vec3& centre, double half = 0.006, double friction = 0.8) {
  return {{{Kind::kBox, {half, half, half}, {}}}, {{}, centre}, 0.003, friction};
}

RigidBody MakeRing(const Vec3& centre) {
  return {{{Kind::kRing, {0.009, 0.002, 0}, {}}}, {{}, centre}, 0.002, 0.8};
}

/// Two jaws that close along x about a point, and a shaft above.
void PoseTool(const Vec3& tip, double opening, Pose (&X)[kToolPartCount]) {
  X[kShaftPart] = {{}, tip + Vec3{0, 0, 0.06}};
  X[kUpperJawPart] = {{}, tip + Vec3{0.5 * opening, 0, 0}};
  X[kLowerJawPart] = {{}, tip - Vec3{0.5 * opening, 0, 0}};
}
constexpr ToolCapsule kParts[kToolPartCount] = {{0.0025, 0.04}, {0.0015, 0.008}, {0.0015, 0.008}};

std::uint64_t HashOf(const RigidWorld& world) {
  base::StateHash hash;
  base::AddStateTo(hash, world);
  return hash.Value();
}

void Play(RigidWorld& world, double seconds) {
  for (int tick = 0; tick < static_cast<int>(std::lround(seconds / kTick)); ++tick) world.Step();
}

TEST(RigidWorld, FallsAsGalileiSaid) {
  RigidWorld world(kDown, kTick);
  const auto cube = world.AddBody(MakeCube({0, 0, 1})).value();
  Play(world, 0.2);
  // semi-implicit steps of tick / 4 run ahead of g t^2 / 2 by g t dt / 2; damping is a hundredth a second
  EXPECT_NEAR(1 - world.PoseOf(cube).translation.z, 0.5 * 9.81 * 0.04, 0.01 * 0.5 * 9.81 * 0.04 + 0.0025);
  EXPECT_NEAR(world.VelocityOf(cube).z, -9.81 * 0.2, 0.01);
}

TEST(RigidWorld, RestsWithoutJitter) {
  RigidWorld world(kDown, kTick);
  ASSERT_TRUE(world.AddBody(MakeFloor()).ok());
  std::vector<std::uint32_t> things;
  for (int level = 0; level < 3; ++level)
    things.push_back(*world.AddBody(MakeCube({0, 0, 0.0065 + 0.0125 * level})));
  things.push_back(*world.AddBody(MakeRing({0.05, 0, 0.01})));
  Play(world, 1.0);
  std::vector<Vec3> settled;
  for (const auto thing : things) settled.push_back(world.PoseOf(thing).translation);
  for (int tick = 0; tick < 60 * 120; ++tick) {
    world.Step();
    for (std::size_t i = 0; i < things.size(); ++i) {
      ASSERT_LT(math::Norm(world.PoseOf(things[i]).translation - settled[i]), 2e-4) << i << " after " << tick;
      ASSERT_LT(math::Norm(world.VelocityOf(things[i])), 5e-3) << i << " after " << tick;
    }
  }
  for (const auto thing : things) EXPECT_TRUE(world.IsAtRest(thing));
  EXPECT_NEAR(settled[0].z, 0.006, 3e-4);
  EXPECT_NEAR(settled[2].z, 0.030, 9e-4);
  EXPECT_NEAR(settled[3].z, 0.002, 3e-4);
}

TEST(RigidWorld, SlidesBeyondTheAngleOfFrictionOnly) {
  for (const double friction : {0.2, 0.6}) {
    for (const double factor : {0.8, 1.25}) {
      const double angle = std::atan(friction) * factor;
      const Vec3 tilted{9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)};
      RigidWorld world(tilted, kTick);
      ASSERT_TRUE(world.AddBody(MakeFloor()).ok());
      const auto cube = *world.AddBody(MakeCube({0, 0, 0.0061}, 0.006, friction));
      Play(world, 0.1);
      const double before = world.PoseOf(cube).translation.x;
      Play(world, 0.25);
      const double moved = world.PoseOf(cube).translation.x - before;
      EXPECT_TRUE(factor < 1 ? moved < 5e-4 : moved > 5e-3) << friction << " " << factor << ": " << moved;
    }
  }
}

TEST(RigidWorld, DoesNotFallThroughAThinBoard) {
  RigidWorld world(kDown, kTick);
  ASSERT_TRUE(world.AddBody({{{Kind::kBox, {0.2, 0.2, 0.0005}, {}}}, {}, 0, 1.0}).ok());
  const auto cube = *world.AddBody(MakeCube({0, 0, 0.8}, 0.003));
  Play(world, 2.0);
  EXPECT_GT(world.PoseOf(cube).translation.z, 0);
}

TEST(RigidWorld, ARingStaysOnItsPeg) {
  RigidWorld world(kDown, kTick);
  ASSERT_TRUE(world.AddBody(MakeFloor()).ok());
  ASSERT_TRUE(
      world.AddBody({{{Kind::kCylinder, {0.0025, 0.0025, 0.0125}, {}}}, {{}, {0, 0, 0.0125}}, 0, 0.8}).ok());
  const auto ring = *world.AddBody(MakeRing({0.002, 0, 0.04}));
  Play(world, 1.5);
  const Vec3 p = world.PoseOf(ring).translation;
  EXPECT_LT(std::hypot(p.x, p.y), 0.007) << "the ring is beside the peg";
  EXPECT_NEAR(p.z, 0.002, 5e-4);
}

/// A cube on the floor between the jaws of one tool, or two at its corners.
struct Bench {
  Bench() {
    (void)world.AddBody(MakeFloor());
    cube = *world.AddBody(MakeCube({0, 0, 0.006}));
    for (const double y : {0.0, 0.1}) {
      Pose X[kToolPartCount];
      PoseTool({0, y, 0.012}, 0.03, X);
      tools.push_back(*world.AddTool(kParts, X));
    }
  }
  void Move(std::uint32_t tool, const Vec3& from, const Vec3& to, double from_opening, double to_opening,
            double seconds) {
    const int ticks = static_cast<int>(std::lround(seconds / kTick));
    for (int tick = 1; tick <= ticks; ++tick) {
      const double t = static_cast<double>(tick) / ticks;
      Pose X[kToolPartCount];
      PoseTool(from + t * (to - from), from_opening + t * (to_opening - from_opening), X);
      world.MoveTool(tool, X);
      world.Step();
    }
  }
  RigidWorld world{kDown, kTick};
  std::uint32_t cube = 0;
  std::vector<std::uint32_t> tools;
};

TEST(RigidWorld, IsGraspedCarriedPassedAndPlaced) {
  Bench bench;
  RigidWorld& world = bench.world;
  EXPECT_EQ(world.FindBodyInJaws(0), -1);
  bench.Move(0, {0, 0, 0.012}, {0, 0, 0.012}, 0.03, 0.0148, 0.5);
  ASSERT_EQ(world.FindBodyInJaws(0), static_cast<std::int32_t>(bench.cube));
  world.Hold(0, bench.cube, 5.0);
  bench.Move(0, {0, 0, 0.012}, {0, 0.05, 0.062}, 0.0148, 0.0148, 1.0);
  const Pose carried = world.PoseOf(bench.cube);
  EXPECT_NEAR(carried.translation.z, 0.056, 1e-3);
  EXPECT_NEAR(carried.translation.y, 0.05, 1e-3);
  EXPECT_NEAR(world.ForceOn(0).z, -0.003 * 9.81, 2e-3) << "a held thing weighs what it weighs";
  // both hold it in the air, then the first lets go
  bench.Move(1, {0, 0.1, 0.012}, {0, 0.05, 0.060}, 0.03, 0.03, 1.0);
  world.Hold(1, bench.cube, 5.0);
  Play(world, 0.2);
  EXPECT_EQ(world.HeldBy(0), static_cast<std::int32_t>(bench.cube));
  world.Release(0);
  Play(world, 0.2);
  EXPECT_EQ(world.HeldBy(0), -1);
  EXPECT_NEAR(world.PoseOf(bench.cube).translation.z, 0.056, 1e-3) << "it fell when the first hand let go";
  bench.Move(1, {0, 0.05, 0.060}, {0, 0.08, 0.011}, 0.03, 0.03, 1.0);
  world.Release(1);
  bench.Move(1, {0, 0.08, 0.011}, {0, 0.08, 0.05}, 0.03, 0.03, 0.5);
  Play(world, 0.5);
  EXPECT_TRUE(world.IsAtRest(bench.cube));
  EXPECT_NEAR(world.PoseOf(bench.cube).translation.z, 0.006, 1e-3);
  EXPECT_NEAR(world.PoseOf(bench.cube).translation.y, 0.08, 3e-3);
}

TEST(RigidWorld, SlipsOutOfJawsThatHoldTooWeakly) {
  Bench weak, strong;
  for (Bench* bench : {&weak, &strong}) {
    // the other tool holds it fast while this one pulls
    bench->world.Hold(1, bench->cube, 1e6);
    bench->world.Hold(0, bench->cube, bench == &weak ? 0.5 : 1e5);
    bench->Move(0, {0, 0, 0.012}, {0, 0, 0.022}, 0.03, 0.03, 0.5);
  }
  EXPECT_EQ(weak.world.HeldBy(0), -1);
  EXPECT_EQ(weak.world.HeldBy(1), static_cast<std::int32_t>(weak.cube));
  EXPECT_GE(strong.world.HeldBy(0), 0);
}

TEST(RigidWorld, IsPushedByATool) {
  Bench bench;
  bench.Move(1, {0, 0.1, 0.010}, {0, -0.02, 0.010}, 0.002, 0.002, 1.0);
  EXPECT_LT(bench.world.PoseOf(bench.cube).translation.y, -0.02);
  EXPECT_EQ(bench.world.HeldBy(1), -1);
}

TEST(RigidWorld, TwoHandsThatTrembleDoNotTearAtWhatTheyHold) {
  for (const bool does_something_fall : {false, true}) {
    Bench bench;
    // what falls fast makes the steps finer; the grip must not grow harder with them
    if (does_something_fall) {
      ASSERT_TRUE(bench.world.AddBody(MakeCube({0.5, 0, 0.5}, 0.001)).ok());
    }
    bench.Move(0, {0, 0, 0.05}, {0, 0, 0.012}, 0.6, 0.6, 0.3);
    bench.Move(0, {0, 0, 0.012}, {0, 0, 0.012}, 0.6, 0.03, 0.3);
    bench.world.Hold(0, bench.cube, 3.0);
    bench.world.Hold(1, bench.cube, 3.0);
    bench.Move(0, {0, 0, 0.012}, {0, 0.0003, 0.0123}, 0.03, 0.03, 0.1);
    Play(bench.world, 0.2);
    EXPECT_EQ(bench.world.HeldBy(0), static_cast<std::int32_t>(bench.cube));
    EXPECT_EQ(bench.world.HeldBy(1), static_cast<std::int32_t>(bench.cube));
    // each gives way by half: 0.2 mm of 2 to 3 N/mm
    EXPECT_GT(math::Norm(bench.world.ForceOn(0)), 0.3);
    EXPECT_LT(math::Norm(bench.world.ForceOn(0)), 0.9);
  }
}

TEST(RigidWorld, WhatHasLeftTheSceneStops) {
  RigidWorld world(kDown, kTick);
  const auto cube = *world.AddBody(MakeCube({0, 0, 0}));
  Play(world, 3.0);
  EXPECT_EQ(world.VelocityOf(cube), Vec3{});
  EXPECT_LT(world.PoseOf(cube).translation.z, -1.0);
  EXPECT_GT(world.PoseOf(cube).translation.z, -1.2);
  world.Reset();
  Play(world, 0.1);
  EXPECT_LT(world.VelocityOf(cube).z, -0.5) << "and falls again after a reset";
}

TEST(RigidWorld, SaysWhichBodiesTouch) {
  RigidWorld world(kDown, kTick);
  const auto floor = *world.AddBody(MakeFloor());
  const auto cube = *world.AddBody(MakeCube({0, 0, 0.0061}));
  const auto ring = *world.AddBody(MakeRing({0.05, 0, 0.05}));
  Play(world, 0.05);
  EXPECT_EQ(world.TouchedBodies(cube), std::uint64_t{1} << floor);
  EXPECT_EQ(world.TouchedBodies(ring), 0u) << "it still falls";
  Play(world, 0.5);
  EXPECT_EQ(world.TouchedBodies(floor), (std::uint64_t{1} << cube) | (std::uint64_t{1} << ring));
}

TEST(RigidWorld, FindsHowDeepAToolEntersWhatNeverMoves) {
  Bench bench;
  std::vector<ToolObstacle> found;
  Pose X[kToolPartCount];
  // jaws are capsules about z, radius 1.5 mm, half length 8 mm: with the tip's centre at 5 mm their ends are at -4.5
  PoseTool({0.05, 0.05, 0.005}, 0.03, X);
  bench.world.FindObstacles(0, X, 0, found);
  ASSERT_EQ(found.size(), 2u) << "both jaws enter the floor, and the cube moves, so it is no obstacle";
  for (const ToolObstacle& one : found) {
    EXPECT_EQ(one.body, 0u);
    EXPECT_NEAR(one.depth, 0.0045, 2e-4);
    EXPECT_NEAR(one.normal.z, -1, 1e-6);
    EXPECT_NEAR(one.point.z, -0.003, 2e-4) << "centre of the capsule's end";
  }
  PoseTool({0.05, 0.05, 0.0105}, 0.03, X);
  bench.world.FindObstacles(0, X, 0, found);
  EXPECT_TRUE(found.empty());
  bench.world.FindObstacles(0, X, 0.002, found);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].depth, -0.001, 2e-4);
}

TEST(RigidWorld, GivesTheSameBitsAgain) {
  Bench first, second;
  const auto operate = [](Bench& bench) {
    bench.Move(1, {0, 0.1, 0.010}, {0, -0.02, 0.010}, 0.002, 0.002, 0.7);
    bench.world.Hold(0, bench.cube, 3.0);
    bench.Move(0, {0, 0, 0.012}, {0.02, 0.03, 0.06}, 0.03, 0.0148, 0.6);
    bench.world.Release(0);
    Play(bench.world, 0.5);
    return HashOf(bench.world);
  };
  const std::uint64_t hash = operate(first);
  EXPECT_EQ(operate(second), hash);
  // from the start again, in the same world
  for (const std::uint32_t tool : {0u, 1u}) {
    Pose X[kToolPartCount];
    PoseTool({0, tool == 0 ? 0.0 : 0.1, 0.012}, 0.03, X);
    first.world.MoveTool(tool, X);
  }
  first.world.Reset();
  EXPECT_EQ(operate(first), hash);
}

/// A cube and a ring that are pushed, held, and let fall on each other, tick by tick.
void Disturb(Bench& bench, int tick) {
  Pose X[kToolPartCount];
  const double t = tick * kTick;
  PoseTool({0.004 * std::sin(3 * t), 0.004 * std::cos(2 * t), 0.012 + 0.01 * std::sin(t)},
           tick % 240 < 120 ? 0.0148 : 0.03, X);
  bench.world.MoveTool(0, X);
  PoseTool({0.02 * std::cos(t), 0.02 * std::sin(t), 0.010}, 0.002, X);
  bench.world.MoveTool(1, X);
  if (tick % 240 == 60) bench.world.Hold(0, bench.cube, 3.0);
  if (tick % 240 == 180) bench.world.Release(0);
  if (tick == 300) bench.world.SetGravity({1, 0, -9.7});
  bench.world.Step();
}

TEST(RigidWorld, GoesOnFromASavedStateToTheSameBits) {
  Bench bench;
  std::vector<std::vector<std::byte>> saved;
  std::vector<std::uint64_t> hashes;
  for (int tick = 0; tick < 600; ++tick) {
    base::SaveState(bench.world, saved.emplace_back());
    hashes.push_back(HashOf(bench.world));
    Disturb(bench, tick);
  }
  const std::uint64_t end = HashOf(bench.world);
  for (const std::size_t from : {0u, 7u, 59u, 61u, 100u, 179u, 181u, 250u, 299u, 301u, 444u, 599u}) {
    for (const bool is_fresh : {true, false}) {
      Bench other;
      Bench& into = is_fresh ? other : bench;
      base::StateArchive archive = base::StateArchive::ForRestore(saved[from]);
      archive.Field("state", into.world);
      ASSERT_TRUE(archive.ok() && archive.IsAtEnd()) << archive.Failure();
      EXPECT_EQ(HashOf(into.world), hashes[from]) << "tick " << from;
      for (int tick = static_cast<int>(from); tick < 600; ++tick) Disturb(into, tick);
      EXPECT_EQ(HashOf(into.world), end) << "from tick " << from << (is_fresh ? " in a fresh world" : "");
    }
  }
}

// Control: each field that is left out is missed.
TEST(RigidWorld, NeedsEachFieldOfItsState) {
  Bench bench;
  for (int tick = 0; tick < 50; ++tick) Disturb(bench, tick);
  std::vector<std::byte> saved;
  base::SaveState(bench.world, saved);
  const std::uint64_t hash = HashOf(bench.world);
  for (const char* field : {"bodies", "tools", "touched", "contacts"}) {
    Bench other;
    base::StateArchive archive = base::StateArchive::ForRestore(saved);
    archive.Omit(std::string("state/") + field);
    archive.Field("state", other.world);
    ASSERT_TRUE(archive.ok()) << archive.Failure();
    EXPECT_NE(HashOf(other.world), hash) << field;
  }
}

TEST(RigidWorld, RefusesAStateOfOtherBodies) {
  Bench bench;
  std::vector<std::byte> saved;
  base::SaveState(bench.world, saved);
  RigidWorld other(kDown, kTick);
  ASSERT_TRUE(other.AddBody(MakeFloor()).ok());
  base::StateArchive archive = base::StateArchive::ForRestore(saved);
  archive.Field("state", other);
  EXPECT_FALSE(archive.ok());
}

TEST(RigidWorld, RefusesWhatIsNoBody) {
  RigidWorld world(kDown, kTick);
  EXPECT_EQ(world.AddBody({}).error().code, base::ErrorCode::kSceneInvalid);
  RigidBody body = MakeCube({0, 0, 0});
  body.shapes[0].size.y = 0;
  EXPECT_FALSE(world.AddBody(body).ok());
  body = MakeCube({0, NAN, 0});
  EXPECT_FALSE(world.AddBody(body).ok());
  body = MakeCube({0, 0, 0});
  body.mass = -1;
  EXPECT_FALSE(world.AddBody(body).ok());
  body = MakeRing({0, 0, 0});
  body.shapes[0].size = {0.002, 0.009, 0};  // thicker than it is wide
  EXPECT_FALSE(world.AddBody(body).ok());
  EXPECT_EQ(world.BodyCount(), 0u);
}

}  // namespace
}  // namespace trocar::rigid
