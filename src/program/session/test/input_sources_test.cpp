// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/input_sources.h"

#include <gtest/gtest.h>

#include "small_scene.h"
#include "trocar/files/task_file.h"
#include "trocar/simulation/simulation.h"

namespace trocar::session {
namespace {

using InputSourcesTest = scene::SmallScene;

TEST_F(InputSourcesTest, TheScriptGoesByTheStatesTimeAndEndsWithItsLastKey) {
  const auto scene = Read();
  ASSERT_TRUE(scene.ok());
  ScriptSource source(*scene);
  EXPECT_TRUE(source.IsDemonstration());
  simulation::Snapshot before;
  for (const double time : {0.0, 0.3, 1.1}) {
    before.time = time;
    EXPECT_EQ(source.For(1, before), scene::CalcScriptInput(*scene, time));
    EXPECT_FALSE(source.IsAtEnd()) << time;
  }
  before.time = 1.2;
  (void)source.For(2, before);
  EXPECT_TRUE(source.IsAtEnd());
  source.Reset();
  EXPECT_FALSE(source.IsAtEnd());
}

// Where nobody can demonstrate, nothing moves, and whoever asks is told that it is over.
TEST_F(InputSourcesTest, WithoutAnExpertTheHandsRest) {
  const auto scene = Read();
  ASSERT_TRUE(scene.ok());
  EXPECT_FALSE(ExpertSource::Suits(*scene));
  ExpertSource source(*scene);
  simulation::Snapshot before;
  before.instruments[instrument::kLeft].joints = {0.1, 0.2, 0.3, 0.12, 0.4};
  before.operation.tools[instrument::kRight] = 3;
  EXPECT_FALSE(source.IsAtEnd());
  const scene::Input input = source.For(1, before);
  EXPECT_EQ(input.hands[instrument::kLeft], before.instruments[instrument::kLeft].joints);
  EXPECT_EQ(input.controls[instrument::kRight].tool, 3);
  EXPECT_TRUE(source.IsAtEnd());
}

TEST(ExpertSource, TakesOverFromTheStateItFindsAndAnewAfterAReset) {
  auto read = files::ReadTask(*files::FindTask("instrument_navigation"));
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  ASSERT_TRUE(ExpertSource::Suits(*scene));
  auto simulation = simulation::Simulation::Make(scene);
  ASSERT_TRUE(simulation.ok());
  // somebody has moved a hand away before
  scene::Input moved = scene::CalcScriptInput(*scene, 0);
  moved.hands[instrument::kRight].pan += 0.15;
  for (int tick = 0; tick < 60; ++tick) simulation->Step(moved);
  ExpertSource source(*scene);
  const simulation::Snapshot& seen = simulation->GetSnapshot();
  const auto found = seen.instruments[instrument::kRight].joints;
  const scene::Input first = source.For(seen.tick + 1, seen);
  EXPECT_NEAR(first.hands[instrument::kRight].pan, found.pan, 0.02) << "no jump";
  for (int tick = 0; tick < 240; ++tick) simulation->Step(source.For(seen.tick + 1, seen));
  EXPECT_GT(std::abs(seen.instruments[instrument::kRight].joints.pan - found.pan) +
                std::abs(seen.instruments[instrument::kLeft].joints.pan -
                         scene->instruments[instrument::kLeft].home.pan),
            0.01)
      << "it works";
  simulation->Reset();
  source.Reset();
  const scene::Input anew = source.For(1, simulation->GetSnapshot());
  EXPECT_NEAR(anew.hands[instrument::kRight].pan, scene->instruments[instrument::kRight].home.pan, 0.02);
}

}  // namespace
}  // namespace trocar::session
