// SPDX-License-Identifier: Apache-2.0
// What the scripted surgeon does with a gallbladder that is off its bed before the critical view was seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "operation_harness.h"
#include "trocar/agent/surgeon.h"
#include "trocar/simulation/simulation.h"

namespace trocar::agent {

using simulation::OperationScene;
using simulation::Snapshot;
namespace {

/// The three criteria are whole, no view counts, both graspers hold, and nothing moves.
/// \param is_off_bed  nothing but duct and artery holds the gallbladder
Snapshot Dissected(const simulation::Simulation& simulation, bool is_off_bed) {
  Snapshot seen = simulation.GetSnapshot();
  const auto strands = simulation.Strands();
  for (std::size_t i = 0; i < strands.size(); ++i) {
    using Kind = scene::StrandInfo::Kind;
    const Kind kind = strands[i].kind;
    const bool is_fat = kind == Kind::kTriangle || kind == Kind::kPeritoneum || kind == Kind::kAdhesion;
    if (is_fat || (kind == Kind::kBed && is_off_bed)) seen.operation.strand_is_intact[i] = 0;
  }
  seen.operation.procedure.measures = {1.0, 0.5, 2};
  seen.operation.procedure.view.criteria = {2, 2, 2};
  seen.operation.assistant.is_holding = true;
  seen.instruments[0].is_grasping = true;
  seen.instruments[0].organ = scene::FindSurface(simulation.Surfaces(), roles::OrganRole::kGallbladder);
  return seen;
}

/// What the expert does in turn from there, as far as the left hand draws to show the other side.
std::vector<std::string> DoingsBeforeDraw(bool is_off_bed) {
  constexpr int kTicks = 12000;
  auto simulation = simulation::Simulation::Make(OperationScene());
  EXPECT_TRUE(simulation.ok());
  auto surgeon = MakeSurgeon("expert", OperationScene(), 1);
  EXPECT_TRUE(surgeon.ok());
  Snapshot seen = Dissected(*simulation, is_off_bed);
  std::vector<std::string> doings;
  bool has_looked = false;
  for (int tick = 0; tick < kTicks; ++tick) {
    (void)(*surgeon)->Act(seen);
    ++seen.tick;
    seen.time += OperationScene()->tick_seconds;
    const std::string doing((*surgeon)->Doing());
    if (!doings.empty() && doings.back() == doing) continue;
    doings.push_back(doing);
    has_looked = has_looked || doing == "look from aside";
    if (has_looked && doing == "draw") return doings;
  }
  return {};
}

bool LetsAssistantRelease(const std::vector<std::string>& doings) {
  return std::find(doings.begin(), doings.end(), "assistant: release") != doings.end();
}

TEST(FreeGallbladder, IsLetGoByTheAssistantBeforeItIsTakenRoundTheDuct) {
  const auto free = DoingsBeforeDraw(true), held = DoingsBeforeDraw(false);
  ASSERT_FALSE(free.empty());
  ASSERT_FALSE(held.empty());
  EXPECT_TRUE(LetsAssistantRelease(free));
  EXPECT_FALSE(LetsAssistantRelease(held)) << "on its bed the neck is turned against the assistant's pull";
}

}  // namespace
}  // namespace trocar::agent
