// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/jaw_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "emulated_line.h"
#include "trocar/device/hand_rig.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

std::vector<JawReading> Parse(std::string_view bytes, std::size_t chunk = 1000,
                              FramerCounts* counts = nullptr) {
  JawFramer framer;
  std::vector<JawReading> readings;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(chunk, bytes.size())))
    framer.Feed(bytes.substr(0, chunk), [&](const JawReading& reading) { readings.push_back(reading); });
  if (counts != nullptr) *counts = framer.Counts();
  return readings;
}

TEST(JawFramer, ReadsLinesWithAndWithoutCarriageReturn) {
  const auto readings = Parse("J,0,17,512\r\nJ,1,4294967295,1023\nJ,0,0,0\n");
  ASSERT_EQ(readings.size(), 3u);
  EXPECT_EQ(readings[0].tool, 0);
  EXPECT_EQ(readings[0].milliseconds, 17u);
  EXPECT_EQ(readings[0].raw, 512);
  EXPECT_EQ(readings[1].tool, 1);
  EXPECT_EQ(readings[1].milliseconds, 4294967295u);
  EXPECT_EQ(readings[1].raw, 1023);
}

TEST(JawFramer, RefusesWhatIsNotExactlyALine) {
  for (const char* line : {"J,2,1,1\n", "J,0,1,1024\n", "J,0,4294967296,1\n", "J,0,1,-1\n", "J,0,1,1 \n",
                           "J,0,1\n", "J,0,,1\n", "j,0,1,1\n", "J,0,1,01\n", "J,0,1,1\r\r\n", "J 0 1 1\n",
                           "J,0,1,1e2\n", "J,0,1,99999999999999999999999999999999\n", "\n"}) {
    FramerCounts counts;
    EXPECT_TRUE(Parse(line, 1000, &counts).empty()) << line;
    EXPECT_GT(counts.garbage, 0u) << line;
  }
  // the good line after a broken one is read
  EXPECT_EQ(Parse("J,0,1J,0,1,5\n").size(), 1u);
}

TEST(JawFramer, GivesTheSameLinesForAnyChunking) {
  math::Random random(2);
  std::string bytes;
  for (int i = 0; i < 300; ++i) {
    bytes +=
        FormatReading({static_cast<int>(random.NextWord() % 2), static_cast<std::uint32_t>(random.NextWord()),
                       static_cast<int>(random.NextWord() % 1024)});
    if (i % 7 == 0) bytes += static_cast<char>(random.NextWord());
  }
  const std::size_t whole = Parse(bytes).size();
  EXPECT_EQ(whole, 300u);
  for (const std::size_t chunk : {1, 2, 3, 10, 33}) EXPECT_EQ(Parse(bytes, chunk).size(), whole);
}

TEST(JawFilter, TakesOutASpikeAndFollowsAStepAtFifteenHertz) {
  JawFilter filter;
  std::uint32_t time = 0;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(filter.Filter({0, time += 5, i == 10 ? 900 : 300}), 300);
  // a step: median of three lags one value, then 1 - exp(-2 pi 15 t)
  double value = 0;
  for (int i = 0; i < 8; ++i) value = filter.Filter({0, time += 5, 700});
  const double seconds = 7 * 0.005;
  EXPECT_NEAR(value, 700 - 400 * std::exp(-2 * 3.14159265358979 * 15 * seconds), 0.01);
}

TEST(JawFilter, StartsAnewAfterAGapAndWhenTheClockRunsOver) {
  JawFilter filter;
  filter.Filter({0, 100, 0});
  EXPECT_EQ(filter.Filter({0, 5000, 800}), 800);
  EXPECT_LT(filter.Filter({0, 5005, 100}), 801);
  JawFilter over;
  over.Filter({0, 0xffffffff, 500});
  over.Filter({0, 4, 500});
  EXPECT_LT(over.Filter({0, 9, 600}), 501) << "5 ms, not a gap";
}

TEST(FitJaw, TakesMediansAndEitherSense) {
  std::vector<int> closed(21, 800), open(21, 210);
  closed[3] = 0;
  open[7] = 1023;
  const auto fit = FitJaw(closed, open);
  ASSERT_TRUE(fit.ok());
  EXPECT_EQ(fit->closed, 800);
  EXPECT_EQ(fit->open, 210);
  EXPECT_EQ(FitJaw(closed, closed).error().code, ErrorCode::kCalibrationPoor);
  EXPECT_EQ(FitJaw({}, open).error().code, ErrorCode::kCalibrationPoor);
}

class JawSensorTest : public testing::Test {
 protected:
  void Make(std::vector<Fault> faults = {}) {
    settings_.calibrations[0] = {850, 150};
    settings_.calibrations[1] = {100, 900};
    host_ = *EmulatorHost::MakeSerial(MakeJawEmulator({settings_.calibrations, CalcHandMotion}),
                                      std::move(faults));
    clock_.Add(*host_);
    driver_ = std::make_unique<JawSensor>(
        settings_, [this] { return OpenSerialPort(host_->Address(), 115200); }, clock_);
  }
  JawSettings settings_;
  std::unique_ptr<EmulatorHost> host_;
  EmulatorClock clock_;
  std::unique_ptr<JawSensor> driver_;
  HandSamples samples_;
};

/// A line whose far end the test writes.
class ScriptedLine : public Transport {
 public:
  explicit ScriptedLine(std::string& bytes) : bytes_(bytes) {}
  IoResult Read(std::span<char> buffer) noexcept override {
    const std::size_t count = std::min(buffer.size(), bytes_.size());
    std::copy_n(bytes_.begin(), count, buffer.begin());
    bytes_.erase(0, count);
    return {count, false};
  }
  IoResult Write(std::string_view bytes) noexcept override { return {bytes.size(), false}; }

 private:
  std::string& bytes_;
};

// a board that hangs may repeat its last line for ever: alive to the eye, and the jaw stands still
TEST(JawSensor, DoesNotSeeAJawWhoseClockStandsStill) {
  std::string bytes;
  ManualClock clock;
  JawSensor sensor(
      {},
      [&]() -> base::Result<std::unique_ptr<Transport>> {
        return std::unique_ptr<Transport>(std::make_unique<ScriptedLine>(bytes));
      },
      clock);
  bytes = FormatReading({0, 0, 100}) + FormatReading({1, 0, 100});
  ASSERT_TRUE(sensor.Configure().ok());
  ASSERT_TRUE(sensor.Activate().ok());
  HandSamples samples;
  double left_hidden = 0, lost = 0;
  bool was_right_seen = true;
  for (int i = 1; i < 200 && lost == 0; ++i) {
    const double now = 0.010 * i;
    clock.Set(now);
    const auto milliseconds = static_cast<std::uint32_t>(10 * i);
    // the left value freezes at 0.2 s, the right one, which is the control, at 0.6 s
    bytes += FormatReading({0, std::min(milliseconds, 200u), 100});
    bytes += FormatReading({1, std::min(milliseconds, 600u), 100});
    if (sensor.Read(samples) == ReadStatus::kLost) lost = now;
    if (left_hidden == 0 && !samples[kLeftHand].is_valid) left_hidden = now;
    if (now < 0.6) was_right_seen = was_right_seen && samples[kRightHand].is_valid;
  }
  EXPECT_NEAR(left_hidden, 0.2 + 0.1, 0.015);
  EXPECT_TRUE(was_right_seen);
  EXPECT_NEAR(lost, 0.6 + 0.5, 0.015) << "nothing new of either for half a second";
}

TEST_F(JawSensorTest, FollowsBothJaws) {
  Make();
  ASSERT_TRUE(driver_->Configure().ok());
  ASSERT_TRUE(driver_->Activate().ok());
  for (int i = 0; i < 200; ++i) {
    clock_.Sleep(0.01);
    driver_->Read(samples_);
    for (const Channel hand : {kLeftHand, kRightHand}) {
      ASSERT_TRUE(samples_[hand].is_valid);
      // the filter lags by about 10 + 10 ms at 1.1 rad/s
      EXPECT_NEAR(samples_[hand].jaw, CalcHandMotion(clock_.Now())[hand].jaw, 0.05);
    }
  }
  EXPECT_EQ(driver_->GetFramerCounts().garbage, 0u);
}

TEST_F(JawSensorTest, IsStaleAfterATenthAndLostAfterHalfASecond) {
  Make({{FaultKind::kSilence, 0.5, 1e9, 0}});
  ASSERT_TRUE(driver_->Configure().ok());
  ASSERT_TRUE(driver_->Activate().ok());
  double stale = 0, lost = 0;
  while (lost == 0 && clock_.Now() < 3) {
    clock_.Sleep(0.004);
    if (driver_->Read(samples_) == ReadStatus::kLost) lost = clock_.Now();
    if (stale == 0 && !samples_[0].is_valid) stale = clock_.Now();
  }
  EXPECT_NEAR(stale - 0.5, 0.1, 0.015);
  EXPECT_NEAR(lost - 0.5, 0.5, 0.015);
}

TEST_F(JawSensorTest, RefusesACalibrationThatCannotBe) {
  Make();
  settings_.calibrations[1] = {500, 520};
  JawSensor driver(
      settings_, [this] { return OpenSerialPort(host_->Address(), 115200); }, clock_);
  EXPECT_EQ(driver.Configure().error().code, ErrorCode::kDeviceSettings);
}

TEST_F(JawSensorTest, SaysThatTheLineIsSilent) {
  Make({{FaultKind::kSilence, 0, 1e9, 0}});
  EXPECT_EQ(driver_->Configure().error().code, ErrorCode::kDeviceStale);
}

/// Gives reports as a HID device does, each at once.
class FakeHid : public Transport {
 public:
  IoResult Read(std::span<char> buffer) noexcept override {
    if (is_gone) return {0, true};
    if (reports.empty()) return {};
    const std::string report = reports.front();
    reports.erase(reports.begin());
    std::copy(report.begin(), report.end(), buffer.begin());
    return {report.size(), false};
  }
  IoResult Write(std::string_view) noexcept override { return {}; }
  std::vector<std::string> reports = {{'\x00', '\x02', '\xff', '\x03'}};  // 512, 1023
  bool is_gone = false;
};

class JawSensorHid : public testing::Test {
 protected:
  JawSensorHid() {
    settings_.format = JawFormat::kHid;
    driver_ = std::make_unique<JawSensor>(
        settings_,
        [&]() -> base::Result<std::unique_ptr<Transport>> {
          auto made = std::make_unique<FakeHid>();
          hid_ = made.get();
          return std::unique_ptr<Transport>(std::move(made));
        },
        clock_);
  }
  void Start() {
    ASSERT_TRUE(driver_->Configure().ok());
    ASSERT_TRUE(driver_->Activate().ok());
  }
  JawSettings settings_;
  ManualClock clock_;
  FakeHid* hid_ = nullptr;
  std::unique_ptr<JawSensor> driver_;
  HandSamples samples_;
};

TEST_F(JawSensorHid, ReadsReports) {
  ASSERT_NO_FATAL_FAILURE(Start());
  EXPECT_EQ(driver_->GetRaw(0), 512);
  EXPECT_EQ(driver_->GetRaw(1), 1023);
  clock_.Set(0.01);
  hid_->reports = {{'\x00', '\x7f', '\x10', '\x00'}};  // 32512 is no value of this converter
  driver_->Read(samples_);
  EXPECT_EQ(driver_->GetRaw(0), 512);
  EXPECT_EQ(driver_->GetRaw(1), 16);
  // several at once: the newest counts
  clock_.Set(0.02);
  hid_->reports = {{'\x01', '\x00', '\x02', '\x00'}, {'\x03', '\x00', '\x04', '\x00'}, "short"};
  driver_->Read(samples_);
  EXPECT_EQ(driver_->GetRaw(0), 3);
  EXPECT_EQ(driver_->GetRaw(1), 4);
  hid_->is_gone = true;
  EXPECT_EQ(driver_->Read(samples_), ReadStatus::kLost);
}

// the USB engine of a board whose program stands still goes on sending the last report
TEST_F(JawSensorHid, AFrozenBoardIsNotSeenAndLostWhereItSendsItsClock) {
  for (const bool has_clock : {true, false}) {
    clock_.Set(0);
    ASSERT_NO_FATAL_FAILURE(Start());
    double hidden = 0, lost = 0;
    for (int i = 1; i < 200 && lost == 0; ++i) {
      const double now = 0.010 * i;
      clock_.Set(now);
      // the clock runs over on the way, and stands still from 0.3 s on
      hid_->reports = {
          FormatHidReport({100, 200}, static_cast<std::uint16_t>(65'400 + 10 * std::min(i, 30)))};
      if (!has_clock) hid_->reports[0].resize(kHidReportSizeWithoutClock);
      if (driver_->Read(samples_) == ReadStatus::kLost) lost = now;
      if (hidden == 0 && !samples_[kLeftHand].is_valid) hidden = now;
    }
    if (!has_clock) {
      EXPECT_EQ(lost, 0.0) << "without a clock it cannot be told from a jaw that is held still";
      EXPECT_TRUE(samples_[kLeftHand].is_valid && samples_[kRightHand].is_valid);
      continue;
    }
    EXPECT_NEAR(hidden, 0.3 + 0.1, 0.015);
    EXPECT_NEAR(lost, 0.3 + 0.5, 0.015);
  }
}

// the emulated sensor gives what the text sensor would: packets, one report each
TEST(JawSensorHidEmulator, IsReadByItsSocket) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Path() / "jaw_hid";
  auto host = *EmulatorHost::MakeLocal(MakeJawEmulator({{}, CalcHandMotion, JawFormat::kHid}), path,
                                       kHidReportSize, {{FaultKind::kUnplug, 2.0, 1e9, 0}});
  EXPECT_EQ(EmulatorHost::MakeLocal(MakeJawEmulator({{}, CalcRest}), path, kHidReportSize).error().code,
            ErrorCode::kDeviceBusy);
  JawSettings settings;
  settings.format = JawFormat::kHid;
  EmulatorClock clock;
  clock.Add(*host);
  JawSensor driver(
      settings, [&] { return OpenHidSensor(path); }, clock);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  HandSamples samples;
  double worst = 0;
  while (clock.Now() < 1.9) {
    clock.Sleep(0.002);
    driver.Read(samples);
    ASSERT_TRUE(samples[kLeftHand].is_valid && samples[kRightHand].is_valid);
    if (clock.Now() < 0.5) continue;  // the low pass settles
    const HandSamples truth = CalcHandMotion(clock.Now());
    for (const int hand : {kLeftHand, kRightHand}) {
      const auto i = static_cast<std::size_t>(hand);
      worst = std::max(worst, std::fabs(samples[i].jaw - truth[i].jaw));
    }
  }
  EXPECT_LT(worst, 0.05) << "rad, by the filter's lag";
  clock.Sleep(0.2);
  EXPECT_EQ(driver.Read(samples), ReadStatus::kLost);
  host.reset();
  EXPECT_FALSE(IsLocalSocket(path)) << "the path is gone with the device";
  EXPECT_FALSE(OpenHidSensor(path).ok());
}

TEST(HandRig, PutsHandsAndJawsTogetherAndIsLostWithEither) {
  EmulatedTracker tracker(PolhemusFormat::kLiberty);
  JawSettings settings;
  auto jaw_host = *EmulatorHost::MakeSerial(MakeJawEmulator({settings.calibrations, CalcHandMotion}));
  tracker.clock.Add(*jaw_host);
  HandRig rig(std::move(tracker.driver),
              std::make_unique<JawSensor>(
                  settings, [&] { return OpenSerialPort(jaw_host->Address(), 115200); }, tracker.clock));
  EXPECT_EQ(rig.GetName(), "liberty and jaw");
  ASSERT_TRUE(rig.Configure().ok());
  ASSERT_TRUE(rig.Activate().ok());
  tracker.clock.Sleep(0.2);
  HandSamples samples;
  EXPECT_EQ(rig.Read(samples), ReadStatus::kFresh);
  const HandSamples truth = CalcHandMotion(tracker.clock.Now());
  EXPECT_TRUE(samples[kRightHand].is_valid);
  EXPECT_NEAR(samples[kRightHand].pan, truth[kRightHand].pan, 0.02);
  EXPECT_NEAR(samples[kRightHand].jaw, truth[kRightHand].jaw, 0.06);
  jaw_host->Unplug();
  EXPECT_EQ(rig.Read(samples), ReadStatus::kLost);
  EXPECT_EQ(rig.Hands().GetState(), DriverState::kUnconfigured);
  EXPECT_EQ(rig.GetState(), DriverState::kUnconfigured);
  // and the tracker alone cannot be had through a rig without its jaws
  EXPECT_FALSE(rig.Configure().ok());
  EXPECT_EQ(rig.Hands().GetState(), DriverState::kUnconfigured);
}

}  // namespace
}  // namespace trocar::device
