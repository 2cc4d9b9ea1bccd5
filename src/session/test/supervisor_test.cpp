// SPDX-License-Identifier: Apache-2.0
// D10: the main process is killed or stopped while force is out; what then arrives at the device, a pseudo-terminal.
// TROCAR_REPEATS sets how often each is done (2 by default); the times are printed.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "trocar/core/clock.h"
#include "trocar/device/simulated_force_device.h"
#include "trocar/session/haptic_loop.h"

namespace trocar::session {
namespace {

using device::SimulatedForceFrame;

/// The device's end of the wire and the process at the other.
class Victim {
 public:
  explicit Victim(const char* supervisor = TROCAR_SUPERVISOR) {
    int slave = -1;
    char name[128];
    EXPECT_EQ(::openpty(&master_, &slave, name, nullptr, nullptr), 0);
    termios raw{};
    ::tcgetattr(slave, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(slave, TCSANOW, &raw);
    ::fcntl(master_, F_SETFD, FD_CLOEXEC);
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(ends[0], STDIN_FILENO);
      ::execl(TROCAR_HAPTIC_VICTIM, TROCAR_HAPTIC_VICTIM, name, supervisor, nullptr);
      ::_exit(9);
    }
    ::close(ends[0]);
    ::close(slave);
    asking_ = ends[1];
  }
  ~Victim() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
    ::close(asking_);
    ::close(master_);
  }

  void Ask() { EXPECT_EQ(::write(asking_, "a", 1), 1); }
  void Kill(int signal) { ::kill(process_, signal); }

  enum class Got { kNothing, kZero, kForce, kClosed };
  /// The next force on the wire, waited for up to `seconds`.
  Got Next(double seconds) {
    const core::Stopwatch watch;
    for (;;) {
      // synchronise on the frame's mark
      while (bytes_.size() >= SimulatedForceFrame::kBytes) {
        if (std::memcmp(bytes_.data(), "TRFC", 4) != 0) {
          bytes_.erase(bytes_.begin());
          continue;
        }
        float force[3];
        std::memcpy(force, bytes_.data() + 8, sizeof force);
        bytes_.erase(bytes_.begin(), bytes_.begin() + SimulatedForceFrame::kBytes);
        return force[0] == 0.0F && force[1] == 0.0F && force[2] == 0.0F ? Got::kZero : Got::kForce;
      }
      const double left = seconds - watch.Seconds();
      if (left <= 0.0) return Got::kNothing;
      pollfd waiting{master_, POLLIN, 0};
      ::poll(&waiting, 1, std::max(1, static_cast<int>(1000 * left)));
      char read[4096];
      const ssize_t size = ::read(master_, read, (waiting.revents & POLLIN) != 0 ? sizeof read : 0);
      if (size > 0) bytes_.insert(bytes_.end(), read, read + size);
      if (size < 0 || ((waiting.revents & POLLHUP) != 0 && size <= 0)) return Got::kClosed;
    }
  }
  /// Asks until force is out.
  bool WaitForForce() {
    const core::Stopwatch watch;
    double asked = 0;
    while (watch.Seconds() < 60.0) {
      if (watch.Seconds() - asked > 0.2) {
        asked = watch.Seconds();
        Ask();
      }
      const Got got = Next(0.05);
      if (got == Got::kForce) return true;
      if (got == Got::kClosed) return false;
    }
    return false;
  }

 private:
  int master_ = -1, asking_ = -1;
  pid_t process_ = -1;
  std::vector<char> bytes_;
};

int Repeats() {
  const char* wanted = std::getenv("TROCAR_REPEATS");
  return wanted != nullptr ? std::max(1, std::atoi(wanted)) : 2;
}

void Report(const char* what, std::vector<double> times) {
  std::sort(times.begin(), times.end());
  std::printf("%s: zero on the wire after %.1f ms (median of %zu), %.1f ms (longest)\n", what,
              1e3 * times[times.size() / 2], times.size(), 1e3 * times.back());
}

TEST(Supervisor, SendsZeroWhenTheSimulatorIsKilled) {
  std::vector<double> times;
  for (int i = 0; i < Repeats(); ++i) {
    Victim victim;
    ASSERT_TRUE(victim.WaitForForce());
    const core::Stopwatch watch;
    victim.Kill(SIGKILL);
    Victim::Got got = Victim::Got::kForce;
    while (got == Victim::Got::kForce) got = victim.Next(5.0);
    times.push_back(watch.Seconds());
    ASSERT_EQ(got, Victim::Got::kZero);
    while (got == Victim::Got::kZero) got = victim.Next(5.0);
    EXPECT_EQ(got, Victim::Got::kClosed) << "force after the zero";
  }
  Report("killed", times);
}

TEST(Supervisor, SendsZeroWhenTheSimulatorHangsAndNothingComesBackByItself) {
  std::vector<double> times;
  for (int i = 0; i < Repeats(); ++i) {
    Victim victim;
    ASSERT_TRUE(victim.WaitForForce());
    const core::Stopwatch watch;
    victim.Kill(SIGSTOP);
    Victim::Got got = Victim::Got::kForce;
    while (got == Victim::Got::kForce) got = victim.Next(5.0);
    times.push_back(watch.Seconds());
    ASSERT_EQ(got, Victim::Got::kZero);
    // it goes on saying so; the process wakes, and the force stays off although the switch is still held
    for (int k = 0; k < 5; ++k) ASSERT_EQ(victim.Next(5.0), Victim::Got::kZero);
    victim.Kill(SIGCONT);
    int forces = 0;
    for (int k = 0; k < 300; ++k) forces += victim.Next(1.0) == Victim::Got::kForce;
    // what was cut off in the middle of a tick may still go out, once
    EXPECT_LE(forces, 1);
    EXPECT_TRUE(victim.WaitForForce()) << "a person can arm again";
  }
  Report("stopped", times);
}

TEST(Supervisor, WithoutItThereIsNoForce) {
  device::SimulatedForceSettings simulated;
  simulated.path = [](int, double) { return Vec3{}; };
  HapticLoopSettings settings;
  settings.hands.emplace_back();
  HapticLink link;
  settings.supervisor = "/nowhere/trocar-supervisor";
  auto missing = HapticLoop::Start(std::make_unique<device::SimulatedForceDevice>(simulated), settings, link);
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, core::ErrorCode::kHapticSupervisor);

  settings.supervisor.clear();
  auto loop = HapticLoop::Start(std::make_unique<device::SimulatedForceDevice>(simulated), settings, link);
  ASSERT_TRUE(loop.ok()) << loop.error().Text();
  const core::Stopwatch watch;
  while ((*loop)->Latest().ticks < 20 && watch.Seconds() < 30.0) ::usleep(1000);
  EXPECT_GE((*loop)->Latest().ticks, 20u);
  EXPECT_FALSE((*loop)->Latest().is_supervised);
  (*loop)->RequestArm();
  ::usleep(200'000);
  EXPECT_EQ((*loop)->Latest().hands[kRight].state, haptics::ArmState::kUnarmed);
  EXPECT_EQ((*loop)->Latest().hands[kRight].reason, haptics::Fault::kSupervisor);
}

TEST(HapticLoop, RefusesHandsThatAreNotChannels) {
  device::SimulatedForceSettings simulated;
  simulated.path = [](int, double) { return Vec3{}; };
  HapticLink link;
  const auto loop = HapticLoop::Start(std::make_unique<device::SimulatedForceDevice>(simulated),
                                      HapticLoopSettings{}, link);
  ASSERT_FALSE(loop.ok());
  EXPECT_EQ(loop.error().code, core::ErrorCode::kDeviceSettings);
}

// D1: unplugged and back.
TEST(HapticLoop, OpensALostDeviceAgainAndLeavesItUnarmed) {
  device::SimulatedForceSettings simulated;
  simulated.path = [](int, double) { return Vec3{}; };
  auto made = std::make_unique<device::SimulatedForceDevice>(simulated);
  device::SimulatedForceDevice& device = *made;
  HapticLoopSettings settings;
  settings.supervisor = TROCAR_SUPERVISOR;
  settings.hands.emplace_back();
  HapticLink link;
  auto loop = HapticLoop::Start(std::move(made), settings, link);
  ASSERT_TRUE(loop.ok()) << loop.error().Text();
  const auto wait_for = [&](auto&& condition) {
    const core::Stopwatch watch;
    while (watch.Seconds() < 30.0) {
      if (condition((*loop)->Latest().hands[kRight])) return true;
      ::usleep(1000);
    }
    return false;
  };
  EXPECT_TRUE(wait_for([](const HapticHandStatus& hand) { return hand.counts.good > 0; }));
  device.SetFault(device::SimulatedFault::kUnplugged);
  EXPECT_TRUE(
      wait_for([](const HapticHandStatus& hand) { return hand.reason == haptics::Fault::kDeviceLost; }));
  const auto good = (*loop)->Latest().hands[kRight].counts.good;
  device.SetFault(device::SimulatedFault::kNone);
  EXPECT_TRUE(wait_for([&](const HapticHandStatus& hand) { return hand.counts.good > good; }));
  EXPECT_EQ((*loop)->Latest().hands[kRight].state, haptics::ArmState::kUnarmed);
}

}  // namespace
}  // namespace trocar::session
