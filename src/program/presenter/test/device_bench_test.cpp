// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/device_bench.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <thread>

#include "trocar/device/emulator.h"
#include "trocar/host/clock.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

/// An emulated device beside a bench with a store of its own; waits are for events.
class DeviceBenchTest : public testing::Test {
 protected:
  void SetUp() override { bench_ = std::make_unique<DeviceBench>(folder_.Path() / "devices.json"); }
  void TearDown() override {
    bench_.reset();
    is_running_ = false;
    if (thread_.joinable()) thread_.join();
  }
  void Plug(std::unique_ptr<device::Emulator> emulator, const std::string& kind) {
    host_ = *device::EmulatorHost::MakeSerial(std::move(emulator));
    spec_ = kind + ":" + host_->Address();
    is_running_ = true;
    thread_ = std::thread([this] {
      for (const host::Stopwatch watch; is_running_; device::SystemClock().Sleep(0.002))
        host_->Step(watch.Seconds());
    });
  }
  void PlugTracker(bool about_tip) {
    hands_ = *device::MakeHandsSettings(device::DefaultTracker());
    for (auto& hand : hands_.calibrations) hand.p_sensor_tip = {0.21, 0.01, -0.02};
    device::PolhemusEmulation emulation;
    emulation.format = device::PolhemusFormat::kLiberty;
    emulation.motion =
        about_tip ? device::MoveAboutTip(hands_) : device::MoveHands(hands_, device::CalcHandMotion);
    Plug(device::MakePolhemusEmulator(emulation), "liberty");
  }
  bool WaitFor(const std::function<bool()>& is_reached) {
    for (const host::Stopwatch watch; watch.Seconds() < 60.0; device::SystemClock().Sleep(0.005)) {
      bench_->Advance(since_start_.Seconds());
      if (is_reached()) return true;
    }
    return false;
  }
  bool WaitForHand() {
    return WaitFor([&] { return bench_->Report().samples[device::kLeftHand].is_valid; });
  }

  host::Stopwatch since_start_;
  test::TemporaryFolder folder_;
  device::TrackedHandsSettings hands_;
  std::unique_ptr<device::EmulatorHost> host_;
  std::string spec_;
  std::atomic<bool> is_running_{false};
  std::atomic<double> jaw_{0.0};  // of both emulated tools [rad]
  std::thread thread_;
  std::unique_ptr<DeviceBench> bench_;
};

TEST_F(DeviceBenchTest, ShowsWhatTheDeviceSays) {
  PlugTracker(false);
  ASSERT_TRUE(bench_->Open(spec_).ok());
  ASSERT_TRUE(WaitFor([&] { return bench_->History().size() > 20; }));
  EXPECT_TRUE(WaitForHand());
  EXPECT_EQ(bench_->Report().message, "liberty is connected");
  EXPECT_TRUE(bench_->Report().sensors[device::kLeftHand].has_value());
  EXPECT_GT(bench_->History().back().time, bench_->History().front().time);
  bench_->Close();
  EXPECT_FALSE(bench_->IsOpen());
  EXPECT_TRUE(bench_->History().empty());
}

TEST_F(DeviceBenchTest, FindsTheTipAndKeepsItWithItsResidual) {
  PlugTracker(true);
  ASSERT_TRUE(bench_->Open(spec_).ok());
  ASSERT_TRUE(WaitForHand());
  ASSERT_TRUE(bench_->Begin(CalibrationStep::kTip, device::kRightHand, 4.0).ok());
  EXPECT_TRUE(bench_->IsMeasuring());
  ASSERT_TRUE(WaitFor([&] { return !bench_->IsMeasuring(); }));
  ASSERT_TRUE(bench_->LastResult().is_kept) << bench_->LastResult().text;
  EXPECT_LT(bench_->LastResult().residual, 0.001);
  EXPECT_NE(bench_->LastResult().text.find("residual"), std::string::npos);
  const auto kept = device::LoadDeviceStore(folder_.Path() / "devices.json").store.Tracker("liberty");
  EXPECT_LT(math::Distance(kept.hands[device::kRightHand].p_sensor_tip, hands_.calibrations[1].p_sensor_tip),
            0.001);
  EXPECT_EQ(kept.hands[device::kLeftHand], device::HandCalibration(device::DefaultTracker().hands[0]));
}

// Negative control: hands that move as in an operation turn about no tip.
TEST_F(DeviceBenchTest, RefusesAPoorFitAndChangesNothing) {
  PlugTracker(false);
  ASSERT_TRUE(bench_->Open(spec_).ok());
  ASSERT_TRUE(WaitForHand());
  ASSERT_TRUE(bench_->Begin(CalibrationStep::kTip, device::kLeftHand, 3.0).ok());
  ASSERT_TRUE(WaitFor([&] { return !bench_->IsMeasuring(); }));
  EXPECT_FALSE(bench_->LastResult().is_kept);
  EXPECT_EQ(bench_->LastResult().text.substr(0, 6), "E-DEV-") << bench_->LastResult().text;
  EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "devices.json"));
}

TEST_F(DeviceBenchTest, FindsTheRangeOfTheJaws) {
  Plug(device::MakeJawEmulator({{},
                                [this](double) {
                                  device::HandSamples hands = device::CalcRest(0.0);
                                  for (auto& hand : hands) hand.jaw = jaw_.load();
                                  return hands;
                                }}),
       "jaw");
  ASSERT_TRUE(bench_->Open(spec_).ok());
  ASSERT_TRUE(WaitFor([&] { return bench_->Report().raw_jaws[0].has_value(); }));
  ASSERT_TRUE(bench_->Begin(CalibrationStep::kJaw, device::kLeftHand, 3.0).ok());
  ASSERT_TRUE(WaitFor([&] {
    if (bench_->Progress() > 0.48) jaw_ = 1.0;
    return !bench_->IsMeasuring();
  }));
  EXPECT_TRUE(bench_->LastResult().is_kept) << bench_->LastResult().text;
}

TEST_F(DeviceBenchTest, SwapsTheSensorsOfTheHands) {
  PlugTracker(false);
  ASSERT_TRUE(bench_->Open(spec_).ok());
  ASSERT_TRUE(bench_->SwapHands().ok());
  const auto kept = device::LoadDeviceStore(folder_.Path() / "devices.json").store.Tracker("liberty");
  EXPECT_EQ(kept.stations[device::kLeftHand], 2);
  EXPECT_EQ(kept.stations[device::kRightHand], 1);
  EXPECT_TRUE(bench_->IsOpen());
  EXPECT_TRUE(WaitForHand());
}

TEST_F(DeviceBenchTest, SaysWhatIsWrong) {
  EXPECT_EQ(bench_->Open("telepathy").error().code, base::ErrorCode::kUsage);
  EXPECT_EQ(bench_->Begin(CalibrationStep::kTip, device::kLeftHand, 1.0).error().code,
            base::ErrorCode::kDeviceState);
  ASSERT_TRUE(bench_->Open("jaw:/dev/no_such_line").ok());
  EXPECT_TRUE(WaitFor([&] { return bench_->Report().message.starts_with("E-DEV-"); }));
  EXPECT_EQ(bench_->Begin(CalibrationStep::kJaw, device::kLaparoscope, 1.0).error().code,
            base::ErrorCode::kUsage);
  EXPECT_EQ(bench_->SwapHands().error().code, base::ErrorCode::kUsage);
}

}  // namespace
}  // namespace trocar::presenter
