// SPDX-License-Identifier: Apache-2.0
#include "haptic_tick.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "haptic_bench.h"
#include "realtime_watch.h"
#include "time_histogram.h"
#include "trocar/host/json.h"

namespace trocar::session {

using instrument::kLeft;
using instrument::kRight;

namespace {

using device::SimulatedFault;
using haptics::ArmState;
using haptics::Fault;

TEST(HapticTick, SendsForceOnlyOnceArmed) {
  HapticBench bench;
  bench.is_touching = true;
  bench.hand = {0, 0, -0.006};
  bench.Run(3000);
  EXPECT_EQ(bench.device->GetForce(0), 0.0);
  EXPECT_EQ(bench.Right().reason, Fault::kPoseUnconfirmed);

  HapticBench armed;
  armed.ArmAndTouch();
  EXPECT_EQ(armed.Right().state, ArmState::kArmed);
  EXPECT_GT(armed.device->GetForce(0), 0.1);
  EXPECT_GT(armed.device->GetForce(1), 0.1);
  EXPECT_EQ(armed.Right().force, armed.device->GetForce(1));
}

TEST(HapticTick, ToolsFollowTheHandsAsFarAsTheTissueLetsThem) {
  HapticBench bench;
  bench.hand = {0.01, 0.02, 0.03};
  bench.Run(10);
  ASSERT_TRUE(bench.link.hands.Update());
  const auto free_hands = bench.link.hands.Front();
  ASSERT_TRUE(free_hands.is_driven[kLeft] && free_hands.is_driven[kRight]);
  const math::Vec3 tip =
      instrument::CalcToolPose(bench.settings.hands[0].p_world_port, free_hands.joints[kLeft]).translation;
  EXPECT_LT(math::Distance(tip, bench.hand), 1e-4);  // the encoders' step
  bench.hand = {};
  bench.Run(100);
  bench.is_touching = true;
  bench.hand = {0, 0, -0.006};
  bench.Run(100);
  ASSERT_TRUE(bench.link.hands.Update());
  const double depth = bench.link.hands.Front().joints[kRight].depth;
  EXPECT_LT(depth, 0.1555);
  EXPECT_GT(depth, 0.1520);
}

// buttons behind safety switch and jaws are pedals; whatever happens to the device lets go of them
TEST(HapticTick, PedalsOfAStylusAreLetGoOfWithEveryFault) {
  constexpr std::uint32_t kSwitch = 1, kPedal = 4;  // the hand's first button: cut
  const auto is_cutting = [](HapticBench& bench) {
    bench.link.hands.Update();
    return bench.link.hands.Front().acts[kRight].IsHeld(device::HandAct::kCut);
  };
  for (const SimulatedFault fault :
       {SimulatedFault::kUnplugged, SimulatedFault::kSilent, SimulatedFault::kNotFinite}) {
    SCOPED_TRACE(static_cast<int>(fault));
    HapticBench bench;
    bench.Run(20);
    bench.SetButtons(0, kSwitch | kPedal);
    bench.Run(10);
    EXPECT_FALSE(is_cutting(bench)) << "not before the debounce";
    bench.Run(10);
    ASSERT_TRUE(is_cutting(bench));
    bench.Run(500);
    ASSERT_TRUE(is_cutting(bench)) << "the control: without a fault it stays down";
    EXPECT_EQ(bench.Right().acts.CountPresses(device::HandAct::kCut), 1u);
    bench.device->SetFault(fault);
    bench.Run(fault == SimulatedFault::kSilent ? 20 : 5);
    EXPECT_FALSE(is_cutting(bench));
    if (fault == SimulatedFault::kUnplugged) continue;  // has to be opened again
    bench.device->SetFault(SimulatedFault::kNone);
    bench.Run(100);
    EXPECT_FALSE(is_cutting(bench)) << "the foot that stayed does not count";
    bench.SetButtons(0, kSwitch), bench.Run(20);
    bench.SetButtons(0, kSwitch | kPedal), bench.Run(20);
    EXPECT_TRUE(is_cutting(bench));
  }
}

TEST(HapticHandsReader, ALoopThatStandsStillHoldsNoPedal) {
  HapticLink link;
  HapticHandsReader reader;
  const auto publish = [&] {
    HapticHands& hands = link.hands.Back();
    hands.is_driven[kRight] = true;
    hands.joints[kRight].depth = 0.14;
    hands.acts[kRight].is_held[static_cast<std::size_t>(device::HandAct::kCoagulate)] = true;
    link.hands.Publish();
  };
  publish();
  EXPECT_EQ(reader.Take(link), nullptr) << "no loop runs";
  link.is_used = true;
  const auto is_burning = [&](instrument::Hand hand) {
    return reader.Take(link)->acts[hand].IsHeld(device::HandAct::kCoagulate);
  };
  for (int tick = 0; tick < 100; ++tick) {
    publish();
    ASSERT_TRUE(is_burning(kRight));
  }
  publish();
  EXPECT_FALSE(is_burning(kLeft));
  EXPECT_EQ(reader.Take(link)->joints[kRight].depth, 0.14);
  for (int tick = 0; tick < HapticHandsReader::kLongestSilence; ++tick) (void)reader.Take(link);
  EXPECT_FALSE(is_burning(kRight));
  EXPECT_TRUE(reader.Take(link)->is_driven[kRight]);
  EXPECT_EQ(reader.Take(link)->joints[kRight].depth, 0.14) << "the hand holds its place";
}

TEST(HapticTick, EveryFaultOfTheDeviceTakesTheForceAway) {
  const struct {
    SimulatedFault fault;
    int ticks;  // until zero
    Fault reason;
  } cases[] = {{SimulatedFault::kUnplugged, 1, Fault::kDeviceLost},
               {SimulatedFault::kSilent, 20, Fault::kSilent},
               {SimulatedFault::kNotFinite, 20, Fault::kBadSamples},
               {SimulatedFault::kJumped, 3, Fault::kJump},
               {SimulatedFault::kAlternating, 6, Fault::kJump},
               {SimulatedFault::kUncalibrated, 1, Fault::kNotCalibrated}};
  for (const auto& wanted : cases) {
    HapticBench bench;
    bench.ArmAndTouch();
    ASSERT_GT(bench.Right().force, 0.1);
    bench.device->SetFault(wanted.fault);
    bench.Run(wanted.ticks);
    EXPECT_EQ(bench.Right().force, 0.0) << haptics::FindFault(wanted.reason).name;
    EXPECT_EQ(bench.Right().state, ArmState::kUnarmed);
    bench.Run(2);
    EXPECT_EQ(bench.device->GetForce(1), 0.0);
    bench.device->SetFault(SimulatedFault::kNone);
    bench.Run(3000);
    EXPECT_EQ(bench.device->GetForce(1), 0.0) << "armed itself";
  }
}

TEST(HapticTick, EveryLossAroundItTakesTheForceAway) {
  HapticBench bench;
  bench.ArmAndTouch();
  bench.input.wants_stop = true;
  bench.Step();
  EXPECT_EQ(bench.Right().reason, Fault::kStopped);
  EXPECT_EQ(bench.device->GetForce(1), 0.0);

  HapticBench let_go;
  let_go.ArmAndTouch();
  let_go.SetButtons(1, 0);
  let_go.Step();
  EXPECT_EQ(let_go.Right().reason, Fault::kDeadMan);
  EXPECT_GT(let_go.device->GetForce(0), 0.1) << "the other hand goes on";

  HapticBench late;
  late.ArmAndTouch();
  late.input.lateness = 0.021;
  late.Step();
  EXPECT_EQ(late.Right().reason, Fault::kOverrun);
  EXPECT_EQ(late.tick->GetStatus().overruns, 1u);

  HapticBench unsupervised;
  unsupervised.ArmAndTouch();
  unsupervised.input.is_supervised = false;
  unsupervised.Step();
  EXPECT_EQ(unsupervised.Right().reason, Fault::kSupervisor);
  EXPECT_EQ(unsupervised.device->GetForce(1), 0.0);

  HapticBench paused;
  paused.ArmAndTouch();
  for (int i = 0; i < 105; ++i) {
    paused.input.now += 0.001;
    paused.tick->Run(paused.input);  // no tissue comes
  }
  EXPECT_EQ(paused.Right().reason, Fault::kSimulation);
  EXPECT_EQ(paused.device->GetForce(1), 0.0);
}

TEST(HapticTick, StatusIsOneLineForAPerson) {
  HapticBench bench;
  bench.Run(5);
  EXPECT_THAT(DescribeHaptics(bench.tick->GetStatus()),
              testing::HasSubstr(": both off: it is not confirmed which device is which hand"));
  bench.ArmAndTouch();
  EXPECT_THAT(DescribeHaptics(bench.tick->GetStatus()),
              testing::ContainsRegex("left armed [0-9]\\.[0-9]+ N; right armed"));
  const auto record = host::JsonDocument::Parse(FormatHapticsJson(bench.tick->GetStatus()), "record");
  ASSERT_TRUE(record.ok());
  EXPECT_THAT(FormatHapticsJson(bench.tick->GetStatus()),
              testing::HasSubstr("\"right\": {\"state\": \"armed\", \"reason\": \"none\""));
  bench.device->SetFault(SimulatedFault::kWarm);
  bench.Run(3);
  EXPECT_THAT(DescribeHaptics(bench.tick->GetStatus()), testing::HasSubstr("motors warm"));
}

/// Ticks in contact, with everything that a tick must not do counted.
RealtimeCounts CountWhileRunning(HapticBench& bench, int ticks) {
  const RealtimeCounts before = RealtimeWatch::Counts();
  for (int i = 0; i < ticks; ++i) {
    if (i % 8 == 0) {
      for (const instrument::Hand side : {kLeft, kRight}) {
        bench.link.patches[side].Back() = bench.patch;
        bench.link.patches[side].Publish();
      }
    }
    bench.input.now += 0.001;
    bench.hand.z = -0.006 + 0.0005 * (i % 97) / 97.0;
    // now and then something goes wrong: that must not allocate either
    bench.device->SetFault(i % 4096 == 4095 ? SimulatedFault::kSilent : SimulatedFault::kNone);
    bench.input.lateness = i % 5000 == 4999 ? 0.03 : 0.0;
    bench.input.wants_arm = i % 100 == 0;
    const RealtimeWatch watch;
    bench.tick->Run(bench.input);
  }
  const RealtimeCounts after = RealtimeWatch::Counts();
  return {after.allocations - before.allocations, after.locks - before.locks, after.waits - before.waits};
}

void ExpectNothingForbidden(int ticks, int rings) {
  if (!RealtimeWatch::IsAvailable()) GTEST_SKIP() << "a sanitizer stands where the watch would";
  HapticBench bench(rings);
  bench.ArmAndTouch();
  ASSERT_GT(bench.Right().force, 0.1);
  const RealtimeCounts counts = CountWhileRunning(bench, ticks);
  EXPECT_EQ(counts.allocations, 0);
  EXPECT_EQ(counts.locks, 0);
  EXPECT_EQ(counts.waits, 0);
}

TEST(HapticTick, NeitherAllocatesNorLocksNorWaits) {
  ExpectNothingForbidden(50'000, 1);
}

TEST(HapticTickSlow, NeitherAllocatesNorLocksNorWaitsInAMillionTicks) {
  ExpectNothingForbidden(1'000'000, tissue::PatchCutter::kMaxRings);
}

// The watch's control: one of each, planted.
TEST(RealtimeWatch, SeesWhatIsPlanted) {
  if (!RealtimeWatch::IsAvailable()) GTEST_SKIP() << "a sanitizer stands where the watch would";
  const RealtimeCounts before = RealtimeWatch::Counts();
  {
    const RealtimeWatch watch;
    void* volatile memory = std::malloc(10);
    std::free(memory);
    pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&mutex);
    pthread_mutex_unlock(&mutex);
    const timespec moment{0, 1};
    nanosleep(&moment, nullptr);
  }
  const RealtimeCounts after = RealtimeWatch::Counts();
  EXPECT_EQ(after.allocations - before.allocations, 2);
  EXPECT_EQ(after.locks - before.locks, 1);
  EXPECT_EQ(after.waits - before.waits, 1);
  void* volatile unwatched = std::malloc(10);
  std::free(unwatched);
  EXPECT_EQ(RealtimeWatch::Counts().allocations, after.allocations);
}

TEST(TimeHistogram, GivesPercentilesToAMicrosecond) {
  TimeHistogram histogram;
  EXPECT_EQ(histogram.CalcPercentile(0.5), 0.0);
  for (int i = 1; i <= 1000; ++i) histogram.Add(1000 * i + 500);
  EXPECT_NEAR(histogram.CalcPercentile(0.5), 500e-6, 1.5e-6);
  EXPECT_NEAR(histogram.CalcPercentile(0.999), 999e-6, 1.5e-6);
  histogram.Add(2'000'000'000);
  EXPECT_DOUBLE_EQ(histogram.Longest(), 2.0);
  EXPECT_DOUBLE_EQ(histogram.CalcPercentile(1.0), 2.0);
}

}  // namespace
}  // namespace trocar::session
