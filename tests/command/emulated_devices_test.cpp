// SPDX-License-Identifier: Apache-2.0
/// \file emulated_devices_test.cpp  The whole simulator on emulated devices: `trocar devices emulate` in one process, the operation in
/// another, as a builder of hardware would try it.
#include <fcntl.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <new>
#include <nlohmann/json.hpp>
#include <thread>

#include "command_fixture.h"
#include "stand_in_hd.h"

namespace trocar {
namespace {

using testing::HasSubstr;

void Wait() {
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

/// A `trocar devices emulate`.
class Emulator {
 public:
  explicit Emulator(std::vector<std::string> words) : child_(WithCommand(std::move(words))) {
    for (int i = 0; i < 3000 && name_.find('\n') == std::string::npos; ++i) Wait(), name_ = child_.Out();
    EXPECT_NE(name_.find('\n'), std::string::npos) << "the emulator says no name";
    name_.resize(std::min(name_.size(), name_.find('\n')));
  }
  const std::string& Name() const { return name_; }

 private:
  static std::vector<std::string> WithCommand(std::vector<std::string> words) {
    words.insert(words.begin(), {TROCAR_PROGRAM, "devices", "emulate"});
    return words;
  }
  test::Process child_;
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
#if !TROCAR_HAS_SPNAV
  if (GetParam().emulate[0] == "spacemouse") GTEST_SKIP() << "this build has no SpaceMouse";
#endif
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

// Faults on demand; those with a time come in the middle of the run, seconds after the devices were found.
TEST_F(EmulatedDevices, TheOperationStandsFaultsThatPass) {
  for (const auto& [fault, ticks] :
       {std::pair{"flips=0.001", 40}, {"flood", 40}, {"jump", 40}, {"silence@5+0.2", 720}}) {
    const Emulator device({"liberty", "--fault", fault});
    const auto result = Simulate(ticks, {"--device", device.Name()});
    ASSERT_EQ(result.status, 0) << fault << ": " << result.err;
    EXPECT_LT(nlohmann::json::parse(result.out).at("residual"), 1.0) << fault;
  }
}

TEST_F(EmulatedDevices, TheOperationSaysWhichDeviceIsGone) {
  const Emulator device({"liberty", "--motion", "rest", "--fault", "unplug@5"});
  const auto lost = Simulate(960, {"--device", device.Name()});
  EXPECT_EQ(lost.status, 1);
  EXPECT_THAT(lost.err, HasSubstr("E-DEV-001"));
}

// --- haptic devices

TEST_F(EmulatedDevices, HaplyLeadsTheToolsAndGetsNoForceThatNobodyAskedFor) {
  const Emulator service({"haply", "--motion", "rest"});
  const auto result = Simulate(120, {"--haptics", service.Name(), "--haptic-record", Path("record.json")});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = nlohmann::json::parse(Read(Path("record.json"))).at("summary");
  EXPECT_GT(summary.at("ticks"), 100);
  for (const char* hand : {"left", "right"}) {
    EXPECT_EQ(summary.at(hand).at("times_lost"), 0) << hand;
    EXPECT_EQ(summary.at(hand).at("armed_s"), 0.0) << hand;
    EXPECT_EQ(summary.at(hand).at("max_force"), 0.0) << hand;
  }
}

// its port still takes callers, whom nobody answers: opening it again must not hold the force's clock up
TEST_F(EmulatedDevices, AHaplyServiceThatAnswersNoMoreIsALostDevice) {
  const Emulator service({"haply", "--motion", "rest", "--fault", "unplug@5"});
  const auto result = Simulate(960, {"--haptics", service.Name(), "--haptic-record", Path("record.json")});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto record = nlohmann::json::parse(Read(Path("record.json")));
  const auto summary = record.at("summary");
  EXPECT_EQ(summary.at("left").at("times_lost"), 1);
  EXPECT_EQ(summary.at("left").at("not_armed_at_the_end_code"), "E-DEV-001");
  EXPECT_GT(summary.at("ticks"), 4000) << "of a thousand a second, for eight seconds";
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
  /// A run that asks for force, beside somebody who does what it says where `is_answered`.
  nlohmann::json RunWithForce(int ticks, bool is_answered) {
    const std::string folder = std::filesystem::path(Path("libHD.so")).parent_path();
    test::Process run(
        {TROCAR_PROGRAM, "simulate", Source("scenes/demonstration.json"), "--ticks", std::to_string(ticks),
         "--haptics", "openhaptics:Left,Right", "--force", "--haptic-record", Path("record.json")},
        {"LD_LIBRARY_PATH=" + folder, std::string(kStandInPage) + "=" + Path("page"),
         "TROCAR_CONFIG_DIR=" + Path("config")});
    state_->is_led = 1;
    // what is asked for, in order, and for how long: a hand lets go before the next button counts
    constexpr std::array kAsked = {"bring the left", "bring the right", "hold the safety switches"};
    constexpr int kPause = 50;
    std::size_t stage = 0;
    for (int waited = 0; !run.HasEnded(); ++waited) {
      Wait();
      const std::string said = run.Err();
      for (; stage < kAsked.size() && said.find(kAsked[stage]) != std::string::npos; ++stage) waited = 0;
      const bool is_pressing = is_answered && waited > kPause;
      state_->buttons[0] = is_pressing && (stage == 1 || stage == 3) ? 1 : 0;
      state_->buttons[1] = is_pressing && (stage == 2 || stage == 3) ? 1 : 0;
    }
    EXPECT_EQ(run.Status(), 0) << run.Err();
    return nlohmann::json::parse(Read(Path("record.json"))).at("summary");
  }
  StandInState* state_ = nullptr;
};

TEST_F(OpenHapticsDevices, ArmForSomebodyWhoAnswersAndHolds) {
  const nlohmann::json summary = RunWithForce(720, true);
  EXPECT_GT(summary.at("left").at("armed_s"), 0.0) << summary.dump();
  EXPECT_GT(summary.at("right").at("armed_s"), 0.0);
  EXPECT_EQ(state_->misuses, 0);
  EXPECT_EQ(state_->devices, 0) << "both were closed";
  for (const auto& force : state_->forces) {
    for (const auto& part : force) EXPECT_EQ(part, 0.0) << "left in the motors";
  }
}

// the control of the test above: nobody answers
TEST_F(OpenHapticsDevices, StayOffWithoutAPerson) {
  const nlohmann::json summary = RunWithForce(240, false);
  EXPECT_EQ(summary.at("left").at("armed_s"), 0.0);
  EXPECT_EQ(summary.at("right").at("armed_s"), 0.0);
}

}  // namespace
}  // namespace trocar
