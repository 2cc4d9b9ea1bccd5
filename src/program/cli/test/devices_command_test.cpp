// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "run_trocar.h"
#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"
#include "trocar/device/hand_recording.h"
#include "trocar/host/clock.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;

/// Commands beside an emulator that runs in real time, with a settings folder of the test's own.
class DevicesCommand : public testing::Test {
 protected:
  void SetUp() override { ::setenv("TROCAR_CONFIG_DIR", folder_.Path().c_str(), 1); }
  void TearDown() override {
    is_running_ = false;
    if (thread_.joinable()) thread_.join();
    ::unsetenv("TROCAR_CONFIG_DIR");
  }
  static device::TrackedHandsSettings Hands() { return *device::MakeHandsSettings(device::DefaultTracker()); }
  /// \return the device's name
  std::string Emulate(device::SensorMotion motion, std::vector<device::Fault> faults = {}) {
    device::PolhemusEmulation emulation;
    emulation.format = device::PolhemusFormat::kLiberty;
    emulation.motion = std::move(motion);
    return Serve("liberty", device::MakePolhemusEmulator(emulation), std::move(faults));
  }
  std::string Serve(const std::string& kind, std::unique_ptr<device::Emulator> emulator,
                    std::vector<device::Fault> faults = {}) {
    host_ = *device::EmulatorHost::MakeSerial(std::move(emulator), std::move(faults));
    thread_ = std::thread([this] {
      for (const host::Stopwatch watch; is_running_; device::SystemClock().Sleep(0.001))
        host_->Step(watch.Seconds());
    });
    return kind + ":" + host_->Address();
  }
  std::string Path(const char* name) const { return folder_.Path() / name; }
  device::DeviceStore Store() const { return device::LoadDeviceStore(folder_.Path() / "devices.json").store; }

  test::TemporaryFolder folder_;
  std::unique_ptr<device::EmulatorHost> host_;
  std::atomic<bool> is_running_{true};
  std::thread thread_;
};

TEST_F(DevicesCommand, ListsKinds) {
  const Printed printed = RunTrocar({"devices", "list"});
  EXPECT_EQ(printed.status, 0);
  for (const char* kind : {"fastrak", "liberty", "patriot", "jaw-hid", "igtl", "gamepad", "spacemouse",
                           "openhaptics", "haply", "play"})
    EXPECT_NE(printed.out.find(kind), std::string::npos) << kind;
  EXPECT_EQ(RunTrocar({"devices", "list", "--json"}).out.front(), '{');
}

TEST_F(DevicesCommand, ShowsWhatADeviceSays) {
  const std::string name = Emulate(device::MoveHands(Hands(), device::CalcHandMotion));
  const Printed printed = RunTrocar({"devices", "test", name, "--seconds", "0.7"});
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_NE(printed.out.find("pan"), std::string::npos);
  EXPECT_NE(printed.out.find("laparoscope not seen"), std::string::npos);
}

TEST_F(DevicesCommand, KeepsWhatCameInBeforeADeviceWasLost) {
  const std::string name = Emulate(device::MoveHands(Hands(), device::CalcHandMotion),
                                   {{device::FaultKind::kUnplug, 1.0, 1e9, 0}});
  const Printed printed = RunTrocar({"devices", "record", name, Path("hands.csv")});
  EXPECT_EQ(printed.status, 1);
  EXPECT_EQ(printed.err.substr(0, 18), "trocar: E-DEV-001 ");
  const auto frames = device::ParseHandFrames(*host::ReadFile(Path("hands.csv")), "hands.csv");
  ASSERT_TRUE(frames.ok());
  EXPECT_GT(frames->size(), 20u);
  EXPECT_EQ(RunTrocar({"devices", "play", Path("hands.csv"), "--seconds", "0.1"}).status, 0);
}

TEST_F(DevicesCommand, CalibratesTipThenTrocarAndKeepsThem) {
  device::TrackedHandsSettings truth = Hands();
  device::HandCalibration& left = truth.calibrations[device::kLeftHand];
  left.p_sensor_tip = {0.29, 0.012, -0.02};
  const std::string name = Emulate(device::MoveAboutTip(truth));
  const Printed printed =
      RunTrocar({"devices", "calibrate", "tip", name, "--hand", "left", "--seconds", "3", "--wait", "0"});
  ASSERT_EQ(printed.status, 0) << printed.err;
  const device::TrackerEntry entry = Store().Tracker("liberty");
  EXPECT_LT(math::Distance(entry.hands[device::kLeftHand].p_sensor_tip, left.p_sensor_tip), 1e-4);
  EXPECT_EQ(entry.hands[device::kRightHand], device::DefaultTracker().hands[device::kRightHand]);
  // about its tip is no movement in a trocar: refused, and what there is stays
  const Printed refused = RunTrocar(
      {"devices", "calibrate", "trocar", name, "--hand", "right", "--seconds", "0.5", "--wait", "0"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(Store().Tracker("liberty"), entry);
}

TEST_F(DevicesCommand, RefusesAJawThatDoesNotMove) {
  const std::string name = Serve("jaw", device::MakeJawEmulator({{}, device::CalcRest}));
  const Printed printed = RunTrocar({"devices", "calibrate", "jaw", name, "--seconds", "1", "--wait", "0"});
  EXPECT_EQ(printed.status, 1);
  EXPECT_EQ(printed.err.substr(0, 18), "trocar: E-DEV-021 ");
  EXPECT_FALSE(fs::exists(folder_.Path() / "devices.json"));
}

TEST_F(DevicesCommand, EmulatesAndPrintsTheNameToUse) {
  const Printed printed = RunTrocar({"devices", "emulate", "patriot", "--seconds", "0.1"});
  EXPECT_EQ(printed.status, 0);
  EXPECT_EQ(printed.out.substr(0, 13), "patriot:/dev/");
  EXPECT_EQ(RunTrocar({"devices", "emulate", "igtl", "--seconds", "0.1"}).out.substr(0, 15),
            "igtl:localhost:");
}

TEST_F(DevicesCommand, RefusesWrongUse) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"devices"},
        {"devices", "test"},
        {"devices", "test", "libery:/dev/x"},
        {"devices", "test", "liberty"},
        {"devices", "emulate", "toaster"},
        {"devices", "emulate", "liberty", "--fault", "gremlins", "--seconds", "0.1"},
        {"devices", "calibrate", "tip", "gamepad"},
        {"devices", "calibrate", "jaw", "liberty:/dev/x"}}) {
    EXPECT_EQ(RunTrocar(words).status, 2) << words.back();
  }
  EXPECT_EQ(RunTrocar({"devices", "test", "liberty:/dev/no_such_line"}).status, 1);
  EXPECT_EQ(RunTrocar({"devices", "play", Path("nothing.csv")}).status, 1);
}

TEST_F(DevicesCommand, WarnsOfDamagedSettingsAndGoesOn) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "devices.json", "{").ok());
  const std::string name = Emulate(device::MoveHands(Hands(), device::CalcHandMotion));
  const Printed printed = RunTrocar({"devices", "test", name, "--seconds", "0.3"});
  EXPECT_EQ(printed.status, 0);
  EXPECT_NE(printed.err.find("E-IO-"), std::string::npos) << printed.err;
}

// a recording holds the hands of a headless run, bit for bit
TEST_F(DevicesCommand, RecordingRepeatsASimulationBitForBit) {
  std::vector<device::HandFrame> frames;
  for (int i = 0; i < 60; ++i) frames.push_back({i / 60.0, device::CalcHandMotion(i / 60.0)});
  ASSERT_TRUE(host::WriteFile(Path("hands.csv"), device::FormatHandFrames(frames)).ok());
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {
        "simulate", std::string(TROCAR_SOURCE_DIR) + "/scenes/demonstration.json", "--ticks", "20", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Printed printed = RunTrocar(words);
    EXPECT_EQ(printed.status, 0) << printed.err;
    const auto at = printed.out.find("\"hash\"");
    return printed.out.substr(at, 30);
  };
  const std::string device = "play:" + Path("hands.csv");
  const std::string hash = run({"--device", device});
  EXPECT_EQ(run({"--device", device}), hash);
  EXPECT_NE(run({}), hash) << "the script's hands are elsewhere";
}

}  // namespace
}  // namespace trocar::cli
