// SPDX-License-Identifier: Apache-2.0
/// \file emulated_devices_test.cpp  The whole simulator on emulated devices: `trocar devices emulate` in one process, the operation in
/// another, as a builder of hardware would try it.
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <thread>

#include "command_fixture.h"
#include "stand_in_hd.h"

namespace trocar {
namespace {

using testing::HasSubstr;

/// A `trocar devices emulate` that lives as long as this does.
class Emulator {
 public:
  explicit Emulator(std::vector<std::string> words) {
    words.insert(words.begin(), {TROCAR_PROGRAM, "devices", "emulate"});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = folder_.Path() / "out";
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    EXPECT_EQ(::posix_spawn(&child_, argv[0], &actions, nullptr, argv.data(), ::environ), 0);
    ::posix_spawn_file_actions_destroy(&actions);
    for (int i = 0; i < 3000 && name_.find('\n') == std::string::npos; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      name_ = core::ReadFile(out).ok() ? *core::ReadFile(out) : std::string();
    }
    EXPECT_NE(name_.find('\n'), std::string::npos) << "the emulator says no name";
    name_.resize(std::min(name_.size(), name_.find('\n')));
  }
  ~Emulator() {
    if (child_ > 0) {
      ::kill(child_, SIGTERM);
      ::waitpid(child_, nullptr, 0);
    }
  }
  Emulator(const Emulator&) = delete;
  Emulator& operator=(const Emulator&) = delete;
  const std::string& Name() const { return name_; }

 private:
  test::TemporaryFolder folder_;
  pid_t child_ = -1;
  std::string name_;
};

class EmulatedDevices : public Command {
 protected:
  test::ProcessResult Simulate(int ticks, const std::vector<std::string>& more,
                               std::vector<std::string> environment = {}) const {
    std::vector<std::string> words = {"simulate", Source("scenes/demonstration.json"), "--ticks",
                                      std::to_string(ticks), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    environment.push_back("TROCAR_CONFIG_DIR=" + Path("config"));
    return Run(words, environment);
  }
  static std::string Hash(const test::ProcessResult& result) {
    EXPECT_EQ(result.status, 0) << result.err;
    return result.status == 0 ? nlohmann::json::parse(result.out).at("hash").get<std::string>() : "";
  }
  /// The same run with a device that never sees a hand.
  std::string HashWithoutHands(int ticks) const {
    std::string recording = "time_s";
    for (const char* hand : {"left", "right", "laparoscope"}) {
      for (const char* column : {"seen", "pan_rad", "tilt_rad", "spin_rad", "depth_m", "jaw_rad"})
        recording += std::string(",") + hand + "_" + column;
    }
    recording += "\n0,0,0,0,0,0.1,0,0,0,0,0,0.1,0,0,0,0,0,0.1,0\n";
    Write("nobody.csv", recording);
    return Hash(Simulate(ticks, {"--device", "play:" + Path("nobody.csv")}));
  }
};

/// What a hand needs beside the device itself, for those that give only a part of it.
struct Kind {
  const char* name;
  std::vector<std::string> emulate;
};
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << kind.name;
}

class EveryKind : public EmulatedDevices, public testing::WithParamInterface<Kind> {};

TEST_P(EveryKind, HoldsTheInstruments) {
  constexpr int kTicks = 40;
  const Emulator device(GetParam().emulate);
  const std::string hash = Hash(Simulate(kTicks, {"--device", device.Name()}));
  EXPECT_NE(hash, HashWithoutHands(kTicks)) << "the operation saw no hand of it";
}

INSTANTIATE_TEST_SUITE_P(Emulated, EveryKind,
                         testing::Values(Kind{"fastrak", {"fastrak"}},
                                         Kind{"fastrak_binary", {"fastrak-binary"}},
                                         Kind{"liberty", {"liberty"}}, Kind{"patriot", {"patriot"}},
                                         Kind{"igtl", {"igtl"}}, Kind{"spacemouse", {"spacemouse"}}),
                         [](const auto& kind) { return kind.param.name; });

// jaws come from a sensor of their own; at rest the tracker alone gives other jaws than with it
TEST_F(EmulatedDevices, JawsComeFromTheirSensor) {
  constexpr int kTicks = 40;
  const Emulator tracker({"liberty", "--motion", "rest"}), text({"jaw"}), hid({"jaw-hid"});
  const std::string alone = Hash(Simulate(kTicks, {"--device", tracker.Name()}));
  for (const Emulator* jaw : {&text, &hid}) {
    const auto with = Simulate(kTicks, {"--device", tracker.Name() + "+" + jaw->Name()});
    EXPECT_NE(Hash(with), alone) << jaw->Name();
  }
}

// faults on demand: the operation goes on through those that pass, and says which device was lost
TEST_F(EmulatedDevices, TheOperationStandsTheirFaults) {
  for (const char* fault : {"flips=0.001", "garbage", "flood", "jump", "silence@4+0.2"}) {
    const Emulator device({"liberty", "--fault", fault});
    const auto result = Simulate(60, {"--device", device.Name()});
    ASSERT_EQ(result.status, 0) << fault << ": " << result.err;
    EXPECT_LT(nlohmann::json::parse(result.out).at("residual"), 1.0) << fault;
  }
  const Emulator device({"liberty", "--fault", "unplug@4"});
  const auto lost = Simulate(720, {"--device", device.Name()});
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("E-DEV-001"));
}

// --- haptic devices

TEST_F(EmulatedDevices, HaplyLeadsTheToolsAndGetsNoForceThatNobodyAskedFor) {
  const Emulator service({"haply"});
  const auto result = Simulate(360, {"--haptics", service.Name(), "--haptic-record", Path("record.json")});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(Read(Path("record.json"))).at("summary");
  EXPECT_GT(summary.at("ticks"), 100);
  for (const char* hand : {"left", "right"}) {
    EXPECT_EQ(summary.at(hand).at("times_lost"), 0) << hand;
    EXPECT_EQ(summary.at(hand).at("armed_s"), 0.0) << hand;
    EXPECT_EQ(summary.at(hand).at("max_force"), 0.0) << hand;
  }
}

TEST_F(EmulatedDevices, AHaplyServiceThatEndsIsALostDevice) {
  const Emulator service({"haply", "--fault", "unplug@4"});
  const auto result = Simulate(840, {"--haptics", service.Name(), "--haptic-record", Path("record.json")});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(Read(Path("record.json"))).at("summary");
  EXPECT_GE(summary.at("left").at("times_lost"), 1);
  EXPECT_EQ(summary.at("left").at("not_armed_at_the_end_code"), "E-DEV-001");
}

/// Two styluses of the stand-in for libHD, led from here.
class OpenHapticsDevices : public EmulatedDevices {
 protected:
  void SetUp() override {
    const std::string path = Path("page");
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    ASSERT_GE(file, 0);
    ASSERT_EQ(::ftruncate(file, sizeof(StandInState)), 0);
    void* const memory = ::mmap(nullptr, sizeof(StandInState), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    ASSERT_NE(memory, MAP_FAILED);
    state_ = new (memory) StandInState;
    std::filesystem::create_symlink(TROCAR_STAND_IN_HD, Path("libHD.so"));
  }
  void TearDown() override {
    if (state_ != nullptr) ::munmap(state_, sizeof(StandInState));
  }
  test::ProcessResult SimulateWithForce(int ticks) const {
    const std::string folder = std::filesystem::path(Path("libHD.so")).parent_path();
    return Simulate(
        ticks, {"--haptics", "openhaptics:Left,Right", "--force", "--haptic-record", Path("record.json")},
        {"LD_LIBRARY_PATH=" + folder, std::string(kStandInPage) + "=" + Path("page")});
  }
  /// Somebody who answers the check pose, left and right, then holds both safety switches.
  void BeAPerson(const std::atomic<bool>& has_ended) {
    constexpr int kReady = 20, kLeft = 40, kChange = 45, kRight = 65, kHold = 70;  // tenths of a second
    state_->is_led = 1;
    for (int tenth = 0; !has_ended; tenth += state_->devices == 2 ? 1 : 0) {
      state_->buttons[0] = tenth >= kHold || (tenth >= kReady && tenth < kLeft) ? 1 : 0;
      state_->buttons[1] = tenth >= kHold || (tenth >= kChange && tenth < kRight) ? 1 : 0;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
  StandInState* state_ = nullptr;
};

TEST_F(OpenHapticsDevices, ArmForSomebodyWhoAnswersAndHolds) {
  std::atomic<bool> has_ended{false};
  std::thread person([&] { BeAPerson(has_ended); });
  const auto result = SimulateWithForce(1500);
  has_ended = true;
  person.join();
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(Read(Path("record.json"))).at("summary");
  EXPECT_GT(summary.at("left").at("armed_s"), 0.0) << summary.dump(1);
  EXPECT_GT(summary.at("right").at("armed_s"), 0.0);
  EXPECT_EQ(state_->misuses, 0);
  EXPECT_EQ(state_->devices, 0) << "both were closed";
  for (const auto& force : state_->forces) {
    for (const auto& part : force) EXPECT_EQ(part, 0.0) << "left in the motors";
  }
}

// the control of the test above: nobody holds a switch
TEST_F(OpenHapticsDevices, StayOffWithoutAPerson) {
  const auto result = SimulateWithForce(480);
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(Read(Path("record.json"))).at("summary");
  EXPECT_EQ(summary.at("left").at("armed_s"), 0.0);
  EXPECT_EQ(summary.at("right").at("armed_s"), 0.0);
}

}  // namespace
}  // namespace trocar
