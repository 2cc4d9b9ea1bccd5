// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/device_presenter.h"

#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "trocar/device/emulator.h"
#include "trocar/host/clock.h"
#include "trocar/presenter/scene_choice.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

/// Remembers what it was told, as a page without widgets.
struct FakeDeviceScreen : DeviceScreen {
  void Show(const DevicePageState& shown) override { state = shown; }
  void ShowFound(const std::vector<std::string>& lines) override { found = lines; }
  void ShowPlot(const std::deque<DeviceBench::Point>& points, const std::deque<ForcePoint>&,
                device::Channel shown, double) override {
    plotted = points.size();
    hand = shown;
  }

  DevicePageState state;
  std::vector<std::string> found;
  std::size_t plotted = 0;
  device::Channel hand = device::kLeftHand;
};

class DevicePresenterTest : public testing::Test {
 protected:
  ~DevicePresenterTest() override {
    presenter_.reset();
    is_running_ = false;
    if (thread_.joinable()) thread_.join();
  }
  void Begin(const Options& options, SessionControl* control = nullptr) {
    presenter_.emplace(options, folder_.Path() / "devices.json", control, screen_);
    presenter_->Start();
  }
  /// An emulated tracker whose tips stand still. \return its name
  std::string PlugTracker() {
    hands_ = *device::MakeHandsSettings(device::DefaultTracker());
    device::PolhemusEmulation emulation;
    emulation.format = device::PolhemusFormat::kLiberty;
    emulation.motion = device::MoveAboutTip(hands_);
    host_ = *device::EmulatorHost::MakeSerial(device::MakePolhemusEmulator(emulation));
    is_running_ = true;
    thread_ = std::thread([this] {
      for (const host::Stopwatch watch; is_running_; device::SystemClock().Sleep(0.002))
        host_->Step(watch.Seconds());
    });
    return "liberty:" + host_->Address();
  }
  template <typename IsReached>
  bool WaitFor(IsReached is_reached) {
    for (const host::Stopwatch watch; watch.Seconds() < 60.0; device::SystemClock().Sleep(0.005)) {
      if (is_reached(presenter_->Advance(since_start_.Seconds()))) return true;
    }
    return false;
  }

  host::Stopwatch since_start_;
  device::TrackedHandsSettings hands_;
  test::TemporaryFolder folder_;
  std::unique_ptr<device::EmulatorHost> host_;
  std::atomic<bool> is_running_{false};
  std::thread thread_;
  FakeDeviceScreen screen_;
  std::optional<DevicePresenter> presenter_;
};

TEST_F(DevicePresenterTest, SaysWhatIsWrong) {
  Begin({});
  EXPECT_FALSE(presenter_->HasControl());
  presenter_->SetSpec("telepathy");
  presenter_->Test();
  EXPECT_TRUE(screen_.state.is_status_warning);
  EXPECT_TRUE(screen_.state.status.starts_with("E-")) << screen_.state.status;
  presenter_->Begin(CalibrationStep::kTip);
  EXPECT_TRUE(screen_.state.status.starts_with("E-DEV-")) << "no device is open";
  (void)presenter_->Advance(1);
  EXPECT_FALSE(screen_.state.can_measure);
  presenter_->Stop();
  EXPECT_EQ(screen_.state.status, "Closed.");
  EXPECT_FALSE(screen_.state.is_status_warning);
  presenter_->ChooseFound(999);
}

TEST_F(DevicePresenterTest, TriesTheDeviceThatTheOptionsName) {
  Options options;
  options.is_device_page = true;
  options.device = PlugTracker();
  Begin(options);
  EXPECT_EQ(screen_.state.spec, options.device);
  ASSERT_TRUE(WaitFor([&](auto) { return screen_.plotted > 10; }));
  EXPECT_EQ(screen_.state.status, "liberty is connected");
  EXPECT_TRUE(screen_.state.can_measure);
  presenter_->ChooseHand(device::kRightHand);
  presenter_->Begin(CalibrationStep::kTip);
  (void)presenter_->Advance(since_start_.Seconds());
  EXPECT_EQ(screen_.hand, device::kRightHand);
  EXPECT_FALSE(screen_.state.can_measure) << "one measurement at a time";
  EXPECT_NE(screen_.state.hint.find("right instrument"), std::string::npos) << screen_.state.hint;
}

TEST_F(DevicePresenterTest, CalibratesByItselfAndReports) {
  Options options;
  options.is_device_page = true;
  options.device = PlugTracker();
  options.calibrate = "tip";
  options.run.screenshot = "devices.png";
  options.run.screenshot_after = 1;
  Begin(options);
  ASSERT_TRUE(WaitFor([](DevicePageRun::Step step) { return step == DevicePageRun::Step::kSave; }));
  EXPECT_FALSE(presenter_->GetFailure());
  EXPECT_TRUE(screen_.state.result.starts_with("Tip kept, ")) << screen_.state.result;
  const auto report = nlohmann::json::parse(presenter_->MakeReport());
  EXPECT_EQ(report["calibrated"], true);
  EXPECT_LT(report["residual_mm"].get<double>(), 1.0);
  EXPECT_EQ(report["device"], options.device);
}

TEST_F(DevicePresenterTest, ReportsADeviceOfAnyNameAsJson) {
  Options options;
  options.is_device_page = true;
  options.device = "liberty:/dev/\"}\n\x1b[2J\xff";
  Begin(options);
  const std::string report = presenter_->MakeReport();
  EXPECT_TRUE(nlohmann::json::accept(report)) << report;
  EXPECT_EQ(report.find('\x1b'), std::string::npos);
}

TEST_F(DevicePresenterTest, AHapticDeviceGivesForceOnlyWhenAsked) {
  Options options;
  options.task = "peg_transfer";
  options.threads = 1;
  auto simulation = MakeChosenSimulation(options);
  ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
  auto control = SessionControl::Make(std::move(simulation).value());
  ASSERT_TRUE(control.ok());
  Begin(options, control->get());
  (void)presenter_->Advance(1);
  EXPECT_FALSE(screen_.state.has_haptics);
  presenter_->CheckPose();  // nothing to do it with
  presenter_->SetForce(true);
  presenter_->UseHaptics("telepathy");
  EXPECT_TRUE(screen_.state.is_status_warning);
  presenter_->SetSpec("jaw:/dev/no_such_line");
  presenter_->Use();
  EXPECT_EQ(screen_.state.status, "The device holds the instruments.");
  presenter_.reset();
}

}  // namespace
}  // namespace trocar::presenter
