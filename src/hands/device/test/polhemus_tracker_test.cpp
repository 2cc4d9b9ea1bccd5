// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/polhemus_tracker.h"

#include <dirent.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "emulated_line.h"
#include "trocar/host/clock.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

class PolhemusTrackerTest : public testing::TestWithParam<PolhemusFormat> {
 protected:
  double Tolerance() const { return GetParam() == PolhemusFormat::kFastrakAscii ? 0.006 : 1e-5; }
};
INSTANTIATE_TEST_SUITE_P(Formats, PolhemusTrackerTest,
                         testing::Values(PolhemusFormat::kFastrakAscii, PolhemusFormat::kFastrakBinary,
                                         PolhemusFormat::kLiberty, PolhemusFormat::kPatriot));

TEST_P(PolhemusTrackerTest, SeesBothHandsOverAPseudoTerminal) {
  EmulatedTracker tracker(GetParam());
  ASSERT_TRUE(tracker.Start());
  int fresh = 0;
  for (int i = 0; i < 300; ++i) {
    tracker.clock.Sleep(0.008);
    if (tracker.Read() != ReadStatus::kFresh) continue;
    ++fresh;
    for (const Channel hand : {kLeftHand, kRightHand}) {
      ASSERT_TRUE(tracker.samples[hand].is_valid);
      // within the age of the record
      const HandSample truth = CalcHandMotion(tracker.clock.Now())[hand];
      EXPECT_NEAR(tracker.samples[hand].pan, truth.pan, Tolerance() + 0.02);
      EXPECT_NEAR(tracker.samples[hand].tilt, truth.tilt, Tolerance() + 0.02);
      EXPECT_NEAR(tracker.samples[hand].depth, truth.depth, Tolerance() + 0.003);
    }
    EXPECT_FALSE(tracker.samples[kLaparoscope].is_valid);
  }
  EXPECT_GT(fresh, 100);
  EXPECT_EQ(tracker.driver->GetFramerCounts().garbage, 0u);
  EXPECT_EQ(tracker.driver->GetPoseCounts().jumps, 0u);
}

// faults D1, D2
TEST_P(PolhemusTrackerTest, IsLostWhenUnpluggedAndComesBackOnlyWhenConfigured) {
  EmulatedTracker tracker(GetParam());
  ASSERT_TRUE(tracker.Start());
  tracker.clock.Sleep(0.1);
  EXPECT_EQ(tracker.Read(), ReadStatus::kFresh);
  tracker.host->Unplug();
  // the very next read says so
  EXPECT_EQ(tracker.Read(), ReadStatus::kLost);
  EXPECT_FALSE(tracker.samples[kLeftHand].is_valid);
  EXPECT_EQ(tracker.driver->GetState(), DriverState::kUnconfigured);
  EXPECT_EQ(tracker.Read(), ReadStatus::kNotActive);
  EXPECT_EQ(tracker.driver->Configure().error().code, ErrorCode::kDeviceLost);
}

TEST(PolhemusTracker, HidesTheHandsInSilenceAndIsLostAfterHalfASecond) {
  EmulatedTracker tracker(PolhemusFormat::kLiberty, {{FaultKind::kSilence, 0.5, 1e9, 0}});
  ASSERT_TRUE(tracker.Start());
  double hidden = 0, lost = 0;
  while (tracker.clock.Now() < 2.0) {
    tracker.clock.Sleep(0.002);
    const ReadStatus status = tracker.Read();
    if (tracker.clock.Now() < 0.5) continue;
    if (hidden == 0 && !tracker.samples[kLeftHand].is_valid) hidden = tracker.clock.Now();
    if (status == ReadStatus::kLost) {
      lost = tracker.clock.Now();
      break;
    }
  }
  EXPECT_NEAR(hidden - 0.5, 0.050, 0.012);
  EXPECT_NEAR(lost - 0.5, 0.500, 0.012);
}

TEST(PolhemusTracker, ShowsNoJumpThatTheTrackerMakes) {
  EmulatedTracker tracker(PolhemusFormat::kLiberty, {{FaultKind::kJump, 0.3, 1e9, 0}});
  ASSERT_TRUE(tracker.Start());
  double worst = 0;
  while (tracker.clock.Now() < 4.0) {
    tracker.clock.Sleep(0.004);
    tracker.Read();
    const HandSample truth = CalcHandMotion(tracker.clock.Now())[kLeftHand];
    worst = std::max(worst, std::fabs(tracker.samples[kLeftHand].pan - truth.pan));
  }
  EXPECT_GT(tracker.driver->GetPoseCounts().jumps, 50u);
  EXPECT_LT(worst, 0.02);
}

// faults D3
TEST(PolhemusTracker, StandsTurnedBitsAndGarbage) {
  for (const double rate : {1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    EmulatedTracker tracker(PolhemusFormat::kLiberty,
                            {{FaultKind::kFlips, 0.2, 1.0, rate}, {FaultKind::kGarbage, 0.2, 1.0, 0}});
    ASSERT_TRUE(tracker.Start());
    ReadStatus status = ReadStatus::kUnchanged;
    double worst = 0;
    while (tracker.clock.Now() < 1.6 && status != ReadStatus::kLost) {
      tracker.clock.Sleep(0.004);
      status = tracker.Read();
      const HandSample truth = CalcHandMotion(tracker.clock.Now())[kLeftHand];
      if (tracker.samples[kLeftHand].is_valid && tracker.clock.Now() > 1.25)
        worst = std::max(worst, std::fabs(tracker.samples[kLeftHand].pan - truth.pan));
    }
    if (rate < 0.05) {
      EXPECT_EQ(status, ReadStatus::kFresh) << rate;
      EXPECT_TRUE(tracker.samples[kLeftHand].is_valid) << rate;
      EXPECT_LT(worst, 0.02) << rate;
    }
    EXPECT_GT(tracker.driver->GetFramerCounts().garbage, 0u);
  }
}

/// A line that swallows so many questions, or all that is written.
class DeafLine : public Transport {
 public:
  DeafLine(std::unique_ptr<Transport> line, int deaf) : line_(std::move(line)), deaf_(deaf) {}
  static constexpr int kAlways = -1;
  IoResult Read(std::span<char> buffer) noexcept override { return line_->Read(buffer); }
  IoResult Write(std::string_view bytes) noexcept override {
    if (deaf_ != kAlways && (bytes != PollCommand() || deaf_ == 0)) return line_->Write(bytes);
    if (deaf_ != kAlways) --deaf_;
    return {bytes.size(), false};
  }

 private:
  std::unique_ptr<Transport> line_;
  int deaf_;
};

// one lost question, or its answer, is no missing tracker
TEST_P(PolhemusTrackerTest, AsksAgainAfterALostAnswer) {
  const auto opens = [&](int lost) {
    EmulatedTracker tracker(GetParam());
    PolhemusTracker driver(
        tracker.settings,
        [&]() -> base::Result<std::unique_ptr<Transport>> {
          auto line = OpenSerialPort(tracker.host->Address(), 115200);
          if (!line) return line.error();
          return std::unique_ptr<Transport>(std::make_unique<DeafLine>(std::move(*line), lost));
        },
        tracker.clock);
    const base::Status done = driver.Configure();
    EXPECT_LT(tracker.clock.Now(), tracker.settings.answer_time + 0.5);
    return done.ok() ? ErrorCode::kNone : done.error().code;
  };
  EXPECT_EQ(opens(0), ErrorCode::kNone);
  EXPECT_EQ(opens(1), ErrorCode::kNone);
  EXPECT_EQ(opens(3), ErrorCode::kNone);
  EXPECT_EQ(opens(DeafLine::kAlways), ErrorCode::kDeviceStale)
      << "the control: one that never answers is refused";
}

// faults D14
TEST(PolhemusTracker, TakesTheNewestOfAFlood) {
  EmulatedTracker tracker(PolhemusFormat::kLiberty, {{FaultKind::kFlood, 0.2, 1e9, 0}});
  ASSERT_TRUE(tracker.Start());
  while (tracker.clock.Now() < 1.0) {
    tracker.clock.Sleep(0.004);
    ASSERT_NE(tracker.Read(), ReadStatus::kLost);
    ASSERT_TRUE(tracker.samples[kLeftHand].is_valid);
    // a hundred records wait where one did, and what counts is still no older than a moment
    const HandSample truth = CalcHandMotion(tracker.clock.Now())[kLeftHand];
    EXPECT_NEAR(tracker.samples[kLeftHand].pan, truth.pan, 0.03) << tracker.clock.Now();
    EXPECT_NEAR(tracker.samples[kLeftHand].depth, truth.depth, 0.004) << tracker.clock.Now();
  }
}

// faults D14, the negative control: a reader that takes what one record needs, and leaves the rest for later
TEST(PolhemusTracker, WithoutTakingAllThatIsThereAFloodIsOldNews) {
  constexpr PolhemusFormat kFormat = PolhemusFormat::kLiberty;
  const EmulatedTracker tracker(kFormat, {{FaultKind::kFlood, 0.2, 1e9, 0}});
  const auto port = *OpenSerialPort(tracker.host->Address(), 115200);
  const int stations[] = {1, 2};
  (void)port->Write(SetUpCommands(kFormat, stations, {1, 0, 0}) + StartCommand(kFormat));
  const SensorMotion truth = MoveHands(tracker.hands, CalcHandMotion);
  PolhemusFramer framer(kFormat);
  double farthest = 0;
  for (double time = 0.004; time < 1.0; time += 0.004) {
    tracker.host->Step(time);
    std::array<char, 64> bytes;
    const IoResult got = port->Read(bytes);
    framer.Feed({bytes.data(), got.count}, [&](const TrackerRecord& record) {
      if (record.station != 1) return;
      const math::Vec3 p = truth(kLeftHand, time).translation;
      const double off = std::min(math::Distance(record.position, p), math::Distance(-record.position, p));
      farthest = std::max(farthest, off);
    });
  }
  EXPECT_GT(framer.Counts().records, 100u);
  EXPECT_GT(farthest, 0.02) << "m";
}

TEST(PolhemusTracker, SaysWhichStationDoesNotAnswer) {
  EmulatedTracker tracker(PolhemusFormat::kLiberty, {}, 1);
  const base::Status status = tracker.driver->Configure();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().Text(),
            "E-DEV-002 liberty: station 2 does not answer; is its sensor plugged in and switched on?");
}

TEST(PolhemusTracker, SaysThatAnotherTrackerAnswers) {
  EmulatedTracker tracker(PolhemusFormat::kLiberty);
  tracker.settings.format = PolhemusFormat::kFastrakBinary;
  PolhemusTracker wrong(
      tracker.settings, [&] { return OpenSerialPort(tracker.host->Address(), 115200); }, tracker.clock);
  const base::Status status = wrong.Configure();
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kDeviceStale);
}

TEST(PolhemusTracker, RefusesSettingsThatCannotWork) {
  EmulatedTracker tracker(PolhemusFormat::kPatriot);
  const auto code = [&](std::array<int, kChannelCount> stations) {
    tracker.settings.stations = stations;
    PolhemusTracker driver(
        tracker.settings, [&] { return OpenSerialPort(tracker.host->Address(), 115200); }, tracker.clock);
    const base::Status status = driver.Configure();
    return status.ok() ? ErrorCode::kNone : status.error().code;
  };
  EXPECT_EQ(code({1, 2, 0}), ErrorCode::kNone);
  EXPECT_EQ(code({1, 1, 0}), ErrorCode::kDeviceSettings);
  EXPECT_EQ(code({1, 3, 0}), ErrorCode::kDeviceSettings) << "a PATRIOT has two stations";
  EXPECT_EQ(code({0, 0, 0}), ErrorCode::kDeviceSettings);
}

TEST(PolhemusTracker, CanBeStoppedAndStartedAgain) {
  EmulatedTracker tracker(PolhemusFormat::kFastrakAscii);
  ASSERT_TRUE(tracker.Start());
  tracker.clock.Sleep(0.1);
  EXPECT_EQ(tracker.Read(), ReadStatus::kFresh);
  ASSERT_TRUE(tracker.driver->Deactivate().ok());
  tracker.clock.Sleep(0.1);
  ASSERT_TRUE(tracker.driver->Activate().ok());
  tracker.clock.Sleep(0.1);
  EXPECT_EQ(tracker.Read(), ReadStatus::kFresh);
  ASSERT_TRUE(tracker.driver->Deactivate().ok());
  ASSERT_TRUE(tracker.driver->Cleanup().ok());
  ASSERT_TRUE(tracker.Start());
}

int CountOpenFiles() {
  int count = 0;
  DIR* folder = ::opendir("/proc/self/fd");
  while (::readdir(folder) != nullptr) ++count;
  ::closedir(folder);
  return count;
}

/// Memory that was asked for and not given back [bytes]. The resident size of a process would not do: the system
/// counts it only roughly.
std::size_t CountMemory() {
  return ::mallinfo2().uordblks;
}

// faults D1: nothing leaks, however often the plug is pulled; TROCAR_REPEATS says how often. Prints how long the read took that
// saw it, for docs/devices.md
TEST(PolhemusTracker, LeavesNoFileOpenAfterManyUnplugs) {
  const char* wanted = std::getenv("TROCAR_REPEATS");
  const int repeats = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 50;
  const int before = CountOpenFiles();
  std::size_t memory = 0;
  std::vector<double> seen_after;  // [ms]
  seen_after.reserve(static_cast<std::size_t>(repeats));
  math::Random random(4);
  for (int i = 0; i < repeats; ++i) {
    const auto format = static_cast<PolhemusFormat>(i % 4);
    EmulatedTracker tracker(format);
    ASSERT_TRUE(tracker.Start()) << i;
    const double moment = tracker.clock.Now() + random.Uniform(0.0, 0.05);
    while (tracker.clock.Now() < moment) {
      ASSERT_NE(tracker.Read(), ReadStatus::kLost) << i;
      tracker.clock.Sleep(0.002);
    }
    const host::Stopwatch watch;
    tracker.host->Unplug();
    ASSERT_EQ(tracker.Read(), ReadStatus::kLost) << i << ": not in the read that follows";
    seen_after.push_back(1e3 * watch.Seconds());
    for (const HandSample& sample : tracker.samples) ASSERT_FALSE(sample.is_valid);
    ASSERT_EQ(tracker.driver->GetState(), DriverState::kUnconfigured);
    // the allocator has what it needs by then
    if (i == repeats / 2) memory = CountMemory();
  }
  EXPECT_EQ(CountOpenFiles(), before);
  const std::size_t after = CountMemory();
  std::sort(seen_after.begin(), seen_after.end());
  std::printf("%d unplugs: seen within %.3f ms (median), %.3f (p99), %.3f (longest)\n", repeats,
              seen_after[seen_after.size() / 2], seen_after[seen_after.size() * 99 / 100], seen_after.back());
  std::printf("%d unplugs: memory %+ld bytes over the second half\n", repeats,
              static_cast<long>(after) - static_cast<long>(memory));
  EXPECT_LE(after, memory + 4096);
}

}  // namespace
}  // namespace trocar::device
