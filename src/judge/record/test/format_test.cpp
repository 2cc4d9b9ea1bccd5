// SPDX-License-Identifier: Apache-2.0
// A file of each format that there has been, kept for ever: what it says is read by every later version.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>

#include "trocar/record/input_codec.h"
#include "trocar/record/recording.h"
#include "trocar/record/recording_list.h"
#include "trocar/record/replay.h"

namespace trocar::record {
namespace {

std::filesystem::path FileOf(int format) {
  return std::filesystem::path(TROCAR_SOURCE_DIR) / "src/judge/record/test/data" /
         ("format_" + std::to_string(format) + ".trocar");
}

TEST(Format, OneIsReadForEver) {
  const auto recording = ReadRecording(FileOf(1));
  ASSERT_TRUE(recording.ok()) << recording.error().Text();
  EXPECT_EQ(recording->damage, "");
  const Description& d = recording->description;
  EXPECT_EQ(d.kind, Description::Kind::kTask);
  EXPECT_EQ(d.name, "peg_transfer");
  EXPECT_EQ(d.level, "normal");
  EXPECT_EQ(d.seed, 3u);
  EXPECT_EQ(d.player, "novice, seed 3");
  EXPECT_EQ(d.program, "0.1.0");
  EXPECT_EQ(d.branched_from, "");
  ASSERT_EQ(recording->inputs.size(), 180u);
  ASSERT_EQ(recording->hashes.size(), 1u);
  EXPECT_EQ(recording->hashes[0].tick, 120u);
  EXPECT_EQ(recording->hashes[0].hash, 0xb5b3f002fbe96e92u);
  ASSERT_TRUE(recording->ending.has_value());
  EXPECT_EQ(recording->ending->ticks, 180u);
  EXPECT_EQ(recording->ending->hash, 0x13e2e79beef4ae25u);
  EXPECT_THAT(recording->ending->outcome, testing::HasSubstr("Ring 1 to the right"));
  const auto summary = ReadSummary(FileOf(1));
  ASSERT_TRUE(summary.ok());
  EXPECT_DOUBLE_EQ(summary->seconds, 1.5);
}

// The same attempt in format 2, written by another program than this (a script, from the description of the bytes).
TEST(Format, TwoHasTheInputsOfOneToTheBit) {
  const auto one = ReadRecording(FileOf(1)), two = ReadRecording(FileOf(2));
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_EQ(two->damage, "");
  EXPECT_EQ(two->description.seed, 3u);
  ASSERT_EQ(two->inputs.size(), one->inputs.size());
  for (std::size_t tick = 0; tick < one->inputs.size(); ++tick) {
    const auto of_one = ListJoints(one->inputs[tick]), of_two = ListJoints(two->inputs[tick]);
    for (std::size_t i = 0; i < kJointCount; ++i) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(of_two[i]), std::bit_cast<std::uint64_t>(of_one[i]))
          << "tick " << tick << ", joint " << i;
    }
    EXPECT_EQ(two->inputs[tick].controls, one->inputs[tick].controls);
    EXPECT_EQ(two->inputs[tick].settings, one->inputs[tick].settings);
  }
  ASSERT_TRUE(two->ending.has_value());
  EXPECT_EQ(two->ending->hash, one->ending->hash);
  EXPECT_LT(std::filesystem::file_size(FileOf(2)), std::filesystem::file_size(FileOf(1)));
}

// It is of an engine whose bits depended on the processor.
TEST(Format, AnotherEngineIsNamedAndNothingElseIsReplayed) {
  auto recording = ReadRecording(FileOf(1));
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->description.engine_bits, 1);
  const auto replay = Replay::Open(std::move(*recording), 1);
  ASSERT_FALSE(replay.ok());
  EXPECT_EQ(replay.error().code, base::ErrorCode::kRecordingInvalid);
  EXPECT_THAT(replay.error().message,
              testing::AllOf(testing::HasSubstr("other last bits"), testing::HasSubstr("Trocar 0.1.0"),
                             testing::HasSubstr("with a program of engine 1")));
}

}  // namespace
}  // namespace trocar::record
