// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recording_source.h"

#include <gtest/gtest.h>

#include "recorded_scene.h"

namespace trocar::record {
namespace {

class RecordingSourceTest : public RecordedScene {
 protected:
  static constexpr std::uint64_t kTicks = 40;
  std::shared_ptr<Recording> Played() {
    Record(kTicks);
    auto recording = ReadRecording(File());
    EXPECT_TRUE(recording.ok());
    return std::make_shared<Recording>(std::move(*recording));
  }
};

TEST_F(RecordingSourceTest, GivesEachTickTheInputItWasMadeWith) {
  RecordingSource source(Played());
  auto simulation = Make();
  while (!source.IsAtEnd()) {
    const std::uint64_t tick = simulation.GetSnapshot().tick + 1;
    const scene::Input input = source.For(tick, simulation.GetSnapshot());
    EXPECT_EQ(input, InputOf(tick - 1)) << tick;
    simulation.Step(input);
  }
  EXPECT_EQ(simulation.GetSnapshot().tick, kTicks);
  EXPECT_EQ(simulation.Hash(), hash_);
  source.Reset();
  EXPECT_FALSE(source.IsAtEnd());
  EXPECT_EQ(source.For(1, simulation.GetSnapshot()), InputOf(0));
}

TEST_F(RecordingSourceTest, RestsAfterItsEndWithoutAPedal) {
  const auto recording = Played();
  recording->inputs.back().controls[0] = {2, true, true, true, true};
  RecordingSource source(recording);
  const simulation::Snapshot none;
  EXPECT_TRUE(source.For(kTicks, none).controls[0].cut);
  const scene::Input rest = source.For(kTicks + 1, none);
  EXPECT_TRUE(source.IsAtEnd());
  EXPECT_EQ(rest.hands, recording->inputs.back().hands);
  EXPECT_EQ(rest.controls[0], (scene::HandControls{.tool = 2}));
}

// a recording that began in the middle of an attempt
TEST_F(RecordingSourceTest, CountsFromTheTickThatARecordingBeginsWith) {
  const auto later = Played();
  later->description.first_tick = 100;
  RecordingSource source(later);
  EXPECT_EQ(source.For(101, {}), InputOf(0));
  EXPECT_EQ(source.For(100 + kTicks, {}), InputOf(kTicks - 1));
  EXPECT_TRUE(source.IsAtEnd());
}

}  // namespace
}  // namespace trocar::record
