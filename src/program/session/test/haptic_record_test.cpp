// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/haptic_record.h"

#include <gtest/gtest.h>

#include "trocar/host/json.h"

namespace trocar::session {

using instrument::kRight;

namespace {

using haptics::ArmState;
using haptics::Fault;

HapticStatus MakeStatus(std::uint64_t ticks) {
  HapticStatus status;
  status.ticks = ticks;
  status.rate = 1000;
  status.is_supervised = true;
  status.hands[kRight].is_present = true;
  return status;
}

std::vector<HapticEventKind> Kinds(const HapticRecord& record) {
  std::vector<HapticEventKind> kinds;
  for (const HapticEvent& event : record.Events()) kinds.push_back(event.kind);
  return kinds;
}

TEST(HapticRecord, SumsUpWhatAPersonWantsToKnow) {
  HapticRecord record;
  HapticStatus status = MakeStatus(0);
  HapticHandStatus& right = status.hands[kRight];
  right.reason = Fault::kDeadMan;
  double time = 100;
  const auto run = [&](double seconds) {
    for (int i = 0; i < 10; ++i) {
      time += seconds / 10;
      status.ticks += static_cast<std::uint64_t>(100 * seconds);
      if (right.state != ArmState::kUnarmed) right.armed_ticks += static_cast<std::uint64_t>(100 * seconds);
      record.Add(time, status);
    }
  };
  status.rate = 0;
  record.Add(time, status);
  run(1);
  status.rate = 1000;
  run(2);
  right.state = ArmState::kArmed, right.reason = Fault::kNone, right.max_force = 2.5, right.clamped_ticks = 7;
  status.rate = 940, status.period_max = 0.0031, status.cpu_max = 0.0002;
  run(4);
  status.rate = 990, status.period_max = 0.0011, status.cpu_max = 0.0001;
  right.is_warm = true, right.heat = 0.9, run(1);
  right.is_warm = false, run(1);
  right.is_warm = true, run(1);
  right.state = ArmState::kUnarmed, right.reason = Fault::kDeviceLost;
  status.overruns = 2;
  run(1);

  const HapticSummary summary = record.CalcSummary();
  EXPECT_NEAR(summary.seconds, 11, 1e-9);
  EXPECT_NEAR(summary.rate, 1000, 1e-6);
  EXPECT_EQ(summary.lowest_rate, 940) << "what is not known yet is no rate";
  EXPECT_EQ(summary.period_max, 0.0031);
  EXPECT_EQ(summary.cpu_max, 0.0002);
  EXPECT_EQ(summary.overruns, 2u);
  const HapticHandSummary& hand = summary.hands[kRight];
  EXPECT_FALSE(summary.hands[instrument::kLeft].is_present);
  EXPECT_NEAR(hand.armed_time, 7, 0.01);
  EXPECT_EQ(hand.longest_reason, Fault::kDeadMan) << "3 s against 1 s";
  EXPECT_EQ(hand.last_reason, Fault::kDeviceLost);
  EXPECT_EQ(hand.clamped_ticks, 7u);
  EXPECT_EQ(hand.max_force, 2.5);
  EXPECT_EQ(hand.max_heat, 0.9);
  EXPECT_EQ(hand.times_warm, 2u);
  EXPECT_EQ(hand.times_lost, 1u);

  const auto document = host::JsonDocument::Parse(FormatSummaryJson(summary), "summary");
  ASSERT_TRUE(document.ok()) << document.error().Text();
  const host::JsonView json = document->Root().Object("right");
  EXPECT_EQ(json.Text("not_armed_longest"), "dead_man");
  EXPECT_EQ(json.Text("not_armed_at_the_end_code"), "E-DEV-001");
  EXPECT_EQ(json.Integer("times_warm"), 2);
  EXPECT_EQ(document->Root().Number("period_max_us"), 3100);
  EXPECT_FALSE(document->Root().Has("left"));
  ASSERT_TRUE(document->Check().ok());
  const auto rows = DescribeSummary(summary);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_NE(rows[4][1].find("nobody holds the safety switch"), std::string::npos) << rows[4][1];
}

TEST(HapticRecord, KeepsEveryChangeAsAnEventWithItsReason) {
  HapticRecord record;
  HapticStatus status = MakeStatus(1);
  const auto add = [&](double time) {
    ++status.ticks;
    record.Add(time, status);
  };
  add(0.0);
  EXPECT_TRUE(record.Events().empty()) << "how it begins is no event";
  status.check_pose = haptics::CheckPoseState::kConfirmed, add(0.1);
  status.hands[kRight].state = ArmState::kRamping, add(0.2);
  status.hands[kRight].state = ArmState::kArmed, status.hands[kRight].force = 1.5, add(0.3);
  status.hands[kRight].is_warm = true, add(0.4);
  status.hands[kRight].state = ArmState::kUnarmed, status.hands[kRight].reason = Fault::kDeviceLost, add(0.5);
  status.hands[kRight].reason = Fault::kPoseUnconfirmed, status.hands[kRight].is_warm = false, add(0.6);
  status.overruns += 3, add(0.7);
  status.hands[kRight].counts.bad += 2, add(0.8);
  status.is_supervised = false, add(0.9);
  using K = HapticEventKind;
  EXPECT_EQ(Kinds(record), (std::vector<K>{K::kConfirmed, K::kArmed, K::kWarm, K::kLost, K::kUnarmed,
                                           K::kBack, K::kCool, K::kOverrun, K::kBadSamples, K::kUnwatched}));
  EXPECT_EQ(record.Events()[4].reason, Fault::kDeviceLost);
  EXPECT_EQ(record.Events()[4].hand, kRight);
  EXPECT_EQ(record.Events()[7].count, 3u);
  EXPECT_EQ(record.Events()[8].count, 2u);

  const auto document = host::JsonDocument::Parse(record.FormatJson(), "record");
  ASSERT_TRUE(document.ok()) << document.error().Text();
  const host::JsonView root = document->Root();
  EXPECT_EQ(root.Array("events").size(), 10u);
  EXPECT_EQ(root.Array("events")[4].Text("code"), "E-DEV-001");
  EXPECT_EQ(root.Array("events")[4].Text("hand"), "right");
  ASSERT_EQ(root.Array("samples").size(), 10u);
  EXPECT_EQ(root.Array("samples")[3].Object("right").Number("force"), 1.5);
  EXPECT_EQ(root.Array("samples")[3].Object("right").Text("state"), "armed");
  EXPECT_FALSE(root.Array("samples")[3].Has("left"));
  EXPECT_FALSE(root.Object("last").BooleanOr("supervised", true));
}

TEST(HapticRecord, TheSameStatusAgainChangesNothing) {
  HapticRecord record;
  HapticStatus status = MakeStatus(5);
  record.Add(0.0, status);
  status.hands[kRight].state = ArmState::kArmed;  // but no tick has gone by
  record.Add(1.0, status);
  EXPECT_EQ(record.SampleCount(), 1u);
  EXPECT_TRUE(record.Events().empty());
}

TEST(HapticRecord, StaysBoundedOverADay) {
  HapticRecord record;
  for (std::uint64_t i = 0; i < 200'000; ++i) {
    HapticStatus status = MakeStatus(i + 1);
    status.hands[kRight].state = i % 2 == 0 ? ArmState::kUnarmed : ArmState::kArmed;
    record.Add(0.432 * static_cast<double>(i), status);
  }
  EXPECT_LE(record.SampleCount(), HapticRecord::kMaxSamples);
  EXPECT_GT(record.SampleCount(), HapticRecord::kMaxSamples / 3);
  EXPECT_EQ(record.Events().size(), HapticRecord::kMaxEvents);
  EXPECT_EQ(record.Events().size() + record.EventsLeftOut(), 199'999u);
}

}  // namespace
}  // namespace trocar::session
