// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/tip_path.h"

#include <gtest/gtest.h>

#include "recorded_scene.h"

namespace trocar::record {
namespace {

class TipPathTest : public RecordedScene {};

TEST_F(TipPathTest, IsWhereTheToolsWereInTheAir) {
  Record(240);
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  const TipPath path = CalcTipPath(*scene_, *recording, 4 * scene_->tick_seconds);
  ASSERT_EQ(path.points[0].size(), 60u);
  auto simulation = Make();
  double largest = 0;
  for (std::uint64_t tick = 0; tick < 240; ++tick) {
    simulation.Step(InputOf(tick));
    if (tick % 4 != 0) continue;
    const auto& now = simulation.GetSnapshot();
    EXPECT_NEAR(path.first_time + static_cast<double>(tick / 4) * path.step, now.time, 1e-9);
    for (std::size_t hand = 0; hand < 2; ++hand)
      largest = std::max(largest, math::Distance(path.points[hand][tick / 4],
                                                 now.instruments[hand].X_world_device.translation));
  }
  EXPECT_LT(largest, 0.001) << "but for hands that are faster than a tool may move";
}

TEST_F(TipPathTest, GivesThePartBetweenTwoTimes) {
  Record(120);
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  const TipPath path = CalcTipPath(*scene_, *recording, scene_->tick_seconds);
  ASSERT_EQ(path.points[1].size(), 120u);
  EXPECT_EQ(path.Between(1, path.first_time, path.first_time + 10 * path.step).size(), 11u);
  EXPECT_EQ(path.Between(1, -5, 1000).size(), 120u);
  EXPECT_EQ(path.Between(1, 900, 1000).size(), 1u);
  EXPECT_EQ(&path.Between(1, 900, 1000)[0], &path.points[1].back());
  EXPECT_TRUE(TipPath().Between(0, 0, 1).empty());
}

}  // namespace
}  // namespace trocar::record
