// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/haptic_record.h"

#include <gtest/gtest.h>

#include "trocar/core/json.h"

namespace trocar::session {
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

  const auto document = core::JsonDocument::Parse(record.FormatJson(), "record");
  ASSERT_TRUE(document.ok()) << document.error().Text();
  const core::JsonView root = document->Root();
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
