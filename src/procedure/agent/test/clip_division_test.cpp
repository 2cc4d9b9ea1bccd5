// SPDX-License-Identifier: Apache-2.0
// How the scripted surgeon goes on where clips do not come to lie where they were closed.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "operation_harness.h"
#include "trocar/agent/surgeon.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/simulation/simulation.h"

namespace trocar::agent {

using math::Vec3;
using simulation::OperationScene;
using simulation::Snapshot;
namespace {

/// The critical view was seen, all fat is gone, and nothing moves.
Snapshot Shown(const simulation::Simulation& simulation) {
  using Kind = scene::StrandInfo::Kind;
  Snapshot seen = simulation.GetSnapshot();
  const auto strands = simulation.Strands();
  for (std::size_t i = 0; i < strands.size(); ++i) {
    const Kind kind = strands[i].kind;
    if (kind == Kind::kTriangle || kind == Kind::kPeritoneum || kind == Kind::kAdhesion)
      seen.operation.strand_is_intact[i] = 0;
  }
  seen.operation.procedure.measures = {1.0, 0.5, 2};
  seen.operation.procedure.view.criteria = {2, 2, 2};
  seen.operation.procedure.view.sights = {1, 1};
  seen.instruments[0].is_grasping = true;
  seen.instruments[0].organ = scene::FindSurface(simulation.Surfaces(), roles::OrganRole::kGallbladder);
  return seen;
}

/// Where the expert closes clips, none of which is ever seen on a duct or artery; tools follow its hands.
std::vector<Vec3> FindClosings() {
  constexpr int kTicks = 30000;
  const auto scene = OperationScene();
  auto simulation = simulation::Simulation::Make(scene);
  EXPECT_TRUE(simulation.ok());
  auto surgeon = MakeSurgeon("expert", scene, 1);
  EXPECT_TRUE(surgeon.ok());
  Snapshot seen = Shown(*simulation);
  std::vector<Vec3> closings;
  bool is_closing = false;
  for (int tick = 0; tick < kTicks && !(*surgeon)->HasFinished(); ++tick) {
    const scene::Input input = (*surgeon)->Act(seen);
    for (std::size_t h = 0; h < input.hands.size(); ++h) {
      seen.instruments[h].X_world_tool =
          instrument::CalcToolPose(scene->instruments[h].p_world_port, input.hands[h]);
      seen.operation.tools[h] = input.controls[h].tool;
    }
    const bool closes = (*surgeon)->Doing() == "close the clip";
    if (closes && !is_closing) closings.push_back(seen.instruments[1].X_world_tool.translation);
    is_closing = closes;
    ++seen.tick;
    seen.time += scene->tick_seconds;
  }
  return closings;
}

// A clip may go round the stump of what is divided already; another in its place would lie over it.
TEST(ClipDivision, ClosesNoSecondClipWhereTheFirstDidNotHold) {
  const std::vector<Vec3> closings = FindClosings();
  ASSERT_GE(closings.size(), 2u);
  for (std::size_t i = 1; i < closings.size(); ++i)
    EXPECT_GT(math::Distance(closings[i], closings[i - 1]), 0.0017) << "closing " << i;
}

}  // namespace
}  // namespace trocar::agent
