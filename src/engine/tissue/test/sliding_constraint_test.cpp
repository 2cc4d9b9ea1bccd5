// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/sliding_constraint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/tissue/element_kinds.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// A triangle on virtual springs, and a straight thread that a hand holds, through its middle and aside of it.
struct Stitch {
  static constexpr double kCorner = 30.0, kSlide = 120.0;    // [N/m]
  static constexpr double kAside = 0.002, kSegment = 0.004;  // [m]
  static constexpr std::uint32_t kThread = 6;                // nodes

  TissueModel model;
  TissueState state;
  ElementArrays elements;
  std::vector<std::uint32_t> thread;

  Stitch() {
    TissueDefinition definition;
    definition.rest = {{0.006, 0, 0}, {-0.003, 0.005, 0}, {-0.003, -0.005, 0}};
    definition.shape_stiffness.assign(3, kCorner);
    for (std::uint32_t i = 0; i < kThread; ++i) {
      thread.push_back(static_cast<std::uint32_t>(definition.rest.size()));
      definition.fixed.push_back(thread.back());
      definition.rest.push_back({kAside, 0, (i - 0.5) * kSegment});
      definition.shape_stiffness.push_back(0.0);
    }
    definition.mass.assign(definition.rest.size(), 0.0);
    model = MakeTissueModel(definition);
    state = MakeRestState(model);
    elements.Of<SlidingConstraint>().push_back(
        {.nodes = {0, 1, 2, thread[0], thread[1]}, .weights = {1. / 3, 1. / 3, 1. / 3}, .stiffness = kSlide});
  }
  SlidingConstraint& Slide() { return elements.Of<SlidingConstraint>()[0]; }
  Vec3 Puncture() const { return (state.position[0] + state.position[1] + state.position[2]) / 3.0; }
  void Draw(double by) {
    for (const std::uint32_t node : thread) state.position[node].z += by;
  }
  SolveReport Solve() {
    return EquilibriumSolver(model).Solve({.kind = SolverKind::kNewtonMultigrid, .max_error = 1e-9},
                                          {.elements = &elements}, state);
  }
};

// Analytic: the triangle, which gives way as three corners side by side, and the constraint in row.
TEST(SlidingConstraint, DrawsThePunctureToTheThread) {
  Stitch stitch;
  EXPECT_TRUE(stitch.Solve().converged);
  const double triangle = 3 * Stitch::kCorner;
  EXPECT_NEAR(stitch.Puncture().x, Stitch::kAside * Stitch::kSlide / (Stitch::kSlide + triangle), 1e-10);
  EXPECT_NEAR(stitch.Puncture().z, 0.0, 1e-12);
  const double force = triangle * stitch.Puncture().x;
  EquilibriumSolver solver(stitch.model);
  const Vec3 on_thread = solver.CalcReaction({.elements = &stitch.elements}, stitch.state, stitch.thread);
  EXPECT_NEAR(on_thread.x, -force, 1e-9);
  EXPECT_NEAR(on_thread.z, 0.0, 1e-12) << "a thread that slides is not held along";
}

// The thread goes through segment by segment, while the triangle stays, and slips out at its end.
TEST(SlidingConstraint, TheThreadSlidesThrough) {
  Stitch stitch;
  EXPECT_TRUE(stitch.Solve().converged);
  const Vec3 before = stitch.Puncture();
  int moved = 0;
  Slide last = Slide::kHolds;
  std::vector<Vec3> visited;
  for (int tick = 0; tick < 60 && last != Slide::kSlippedOut; ++tick) {
    stitch.Draw(-0.0005);
    last = FollowSlide(stitch.thread, stitch.state.position, stitch.Slide());
    if (last == Slide::kSlippedOut) break;
    moved += last == Slide::kMoved;
    EXPECT_TRUE(stitch.Solve().converged);
    EXPECT_LT(math::Distance(stitch.Puncture(), before), 1e-4) << "tick " << tick;
  }
  EXPECT_EQ(last, Slide::kSlippedOut);
  EXPECT_EQ(moved, static_cast<int>(Stitch::kThread) - 2);
  EXPECT_EQ(stitch.Slide().nodes[4], stitch.thread.back());
  // and back again, from the other end
  stitch.Draw(0.0055);
  EXPECT_EQ(FollowSlide(stitch.thread, stitch.state.position, stitch.Slide()), Slide::kMoved);
  EXPECT_EQ(stitch.Slide().nodes[3], stitch.thread[Stitch::kThread - 3]);
}

// Saved between two ticks, the segment and all that follows are the same to the bit.
TEST(SlidingConstraint, GoesOnAfterRestoringToTheSameBits) {
  const auto go_on = [](Stitch& stitch) {
    for (int tick = 0; tick < 10; ++tick) {
      stitch.Draw(-0.0005);
      (void)FollowSlide(stitch.thread, stitch.state.position, stitch.Slide());
      (void)stitch.Solve();
    }
  };
  Stitch stitch;
  go_on(stitch);
  std::vector<std::byte> bytes;
  base::StateArchive save = base::StateArchive::ForSave(bytes);
  VisitState(save, stitch.state);
  VisitState(save, stitch.elements, stitch.model.Size());
  Stitch restored;
  base::StateArchive restore = base::StateArchive::ForRestore(bytes);
  VisitState(restore, restored.state);
  VisitState(restore, restored.elements, restored.model.Size());
  ASSERT_TRUE(restore.ok()) << restore.Failure();
  EXPECT_NE(restored.Slide().nodes[3], restored.thread[0]) << "nothing had slid";
  go_on(stitch), go_on(restored);
  EXPECT_EQ(restored.state.position, stitch.state.position);
  EXPECT_EQ(restored.Slide().nodes, stitch.Slide().nodes);
}

}  // namespace
}  // namespace trocar::tissue
