// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/motion_recorder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace trocar::training {
namespace {

std::array<ToolSample, 2> SamplesAt(double x) {
  std::array<ToolSample, 2> samples;
  samples[0].tip = {x, 0, 0};
  samples[1].tip = {-x, 0, 0};
  return samples;
}

TEST(MotionRecorder, KeepsTicksAndEventsInOrder) {
  MotionRecorder recorder({.dt = 0.01, .reserve_seconds = 1.0});
  EXPECT_TRUE(recorder.Record(SamplesAt(1)));
  EXPECT_TRUE(recorder.RecordEvent(1, GraspEventKind::kSuccess));
  EXPECT_TRUE(recorder.Record(SamplesAt(2)));
  const MotionRecording& recording = recorder.Recording();
  ASSERT_EQ(recording.Ticks(), 2u);
  EXPECT_EQ(recording.tools[0][1].tip.x, 2);
  EXPECT_EQ(recording.tools[1][1].tip.x, -2);
  ASSERT_EQ(recording.events.size(), 1u);
  EXPECT_EQ(recording.events[0].tick, 1u);
  EXPECT_EQ(recording.events[0].tool, 1u);
}

// The room is never left: the samples stay where they were reserved, and what does not fit is counted.
TEST(MotionRecorder, DropsAndCountsWhatDoesNotFit) {
  MotionRecorder recorder({.dt = 0.01, .reserve_seconds = 0.1, .reserve_events = 1});
  const ToolSample* const room = recorder.Recording().tools[0].data();
  while (recorder.SecondsLeft() > 0.0) ASSERT_TRUE(recorder.Record(SamplesAt(1)));
  const std::size_t ticks = recorder.Recording().Ticks();
  EXPECT_GE(ticks, 10u);
  EXPECT_FALSE(recorder.Record(SamplesAt(2)));
  EXPECT_EQ(recorder.Recording().Ticks(), ticks);
  EXPECT_EQ(recorder.Recording().dropped_ticks, 1u);
  EXPECT_EQ(recorder.Recording().tools[0].data(), room);
  while (recorder.RecordEvent(0, GraspEventKind::kAttempt))
    ASSERT_LT(recorder.Recording().events.size(), 100u);
  EXPECT_FALSE(recorder.RecordEvent(2, GraspEventKind::kAttempt)) << "there is no third tool";
  recorder.Reserve(1.0, 10);
  EXPECT_TRUE(recorder.Record(SamplesAt(3)));
  EXPECT_TRUE(recorder.RecordEvent(0, GraspEventKind::kSlip));
  recorder.Clear();
  EXPECT_EQ(recorder.Recording().Ticks(), 0u);
  EXPECT_GT(recorder.SecondsLeft(), 1.0);
}

TEST(MotionRecorder, HoldsTheLastGoodSample) {
  MotionRecorder recorder({.dt = 0.01});
  std::array<ToolSample, 2> bad = SamplesAt(5);
  bad[1].tip.y = std::nan("");
  EXPECT_FALSE(recorder.Record(bad)) << "nothing to hold yet";
  EXPECT_TRUE(recorder.Record(SamplesAt(1)));
  EXPECT_TRUE(recorder.Record(bad));
  const MotionRecording& recording = recorder.Recording();
  ASSERT_EQ(recording.Ticks(), 2u);
  EXPECT_EQ(recording.tools[0][1].tip.x, 5) << "the other tool goes on";
  EXPECT_EQ(recording.tools[1][1].tip, recording.tools[1][0].tip);
  EXPECT_EQ(recording.held_ticks, 1u);
  EXPECT_EQ(recording.dropped_ticks, 1u);
}

}  // namespace
}  // namespace trocar::training
