// SPDX-License-Identifier: Apache-2.0
// libHD in the supervisor's process: what the motors do when the simulator's process is killed, stopped or well.
#include <gtest/gtest.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "child_processes.h"
#include "openhaptics/hd_host_page.h"
#include "stand_in_gate.h"
#include "stand_in_page.h"
#include "trocar/device/companion.h"
#include "trocar/device/file_messages.h"
#include "trocar/device/open_haptics.h"
#include "trocar/device/ports.h"
#include "trocar/host/clock.h"
#include "wait_for.h"

namespace trocar::session {
namespace {

using device::ForceSample;
using device::OpenHaptics;
using device::ReadStatus;
using device::WaitFor;

class OpenHapticsHost : public testing::Test {
 protected:
  void SetUp() override {
    settings_.hd_file = TROCAR_STAND_IN_HD;
    settings_.names = {"Left", "Right"};
    // another one where tools/mutate-safety changes it
    const char* other = std::getenv("TROCAR_TEST_SUPERVISOR");
    settings_.host = other != nullptr ? other : TROCAR_SUPERVISOR;
  }
  bool IsPushing() const { return motors_->forces[0][0] != 0 || motors_->forces[1][0] != 0; }

  /// Another process that pushes with both devices until it is killed. Returns once the motors push.
  pid_t StartVictim() {
    const pid_t process = ::fork();
    if (process == 0) {
      OpenHaptics driver(settings_);
      if (!driver.Configure() || !driver.Activate()) ::_exit(1);
      // as the haptic loop, where that is granted: a gap of 10 ms would be zero of its own
      sched_param parameters{};
      parameters.sched_priority = sched_get_priority_min(SCHED_FIFO) + 10;
      ::sched_setscheduler(0, SCHED_FIFO, &parameters);
      for (;;) {
        for (int channel = 0; channel < 2; ++channel)
          driver.SendForce(channel, haptics::ForceGate::Make({1.5, 0, 0}));
        device::SystemClock().Sleep(0.001);
      }
    }
    EXPECT_TRUE(WaitFor(10, [&] { return IsPushing(); }));
    device::SystemClock().Sleep(0.05);
    EXPECT_TRUE(WaitFor(10, [&] { return IsPushing(); })) << "it goes on pushing";
    return process;
  }
  static void Kill(pid_t process) {
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
  }

  static bool IsRealTimePermitted() {
    sched_param parameters{};
    parameters.sched_priority = sched_get_priority_min(SCHED_FIFO) + 15;
    const bool is_permitted = ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
    const sched_param ordinary{};
    ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
    return is_permitted;
  }

  device::OpenHapticsSettings settings_;
  StandInPage page_;
  StandInState* const motors_ = page_.Get();
};

TEST_F(OpenHapticsHost, ReadsAndPushesThroughTheOtherProcess) {
  OpenHaptics driver(settings_);
  const base::Status configured = driver.Configure();
  ASSERT_TRUE(configured.ok()) << configured.error().Text();
  EXPECT_NE(motors_->process, ::getpid()) << "the library lives elsewhere";
  EXPECT_EQ(motors_->devices, 2);
  EXPECT_EQ(driver.GetLimits(0).max_force, 3.3);
  EXPECT_NEAR(driver.GetLimits(1).max_stiffness, 1020, 1e-9);
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  ASSERT_TRUE(WaitFor(3, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  EXPECT_NEAR(samples[0].position.x, -0.04, 1e-12);
  EXPECT_NEAR(samples[1].position.x, 0.04, 1e-12);
  EXPECT_EQ(samples[0].buttons, 1u);
  EXPECT_FALSE(IsPushing());
  ASSERT_TRUE(WaitFor(3, [&] {
    driver.SendForce(1, haptics::ForceGate::Make({0.75, 0, 0}));
    return motors_->forces[1][0] == 0.75;
  }));
  EXPECT_EQ(motors_->forces[0][0], 0.0) << "only the device that is meant";
  ASSERT_TRUE(WaitFor(3, [&] { return !IsPushing(); })) << "nobody renewed it";
  ASSERT_TRUE(driver.Deactivate().ok());
  ASSERT_TRUE(driver.Activate().ok()) << "and again";
  ASSERT_TRUE(WaitFor(3, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  driver.Finalize();
  EXPECT_EQ(motors_->devices, 0);
  EXPECT_EQ(motors_->misuses, 0);
}

// faults D10. The times are printed, for docs/haptics.md; with TROCAR_REPEATS more of them
TEST_F(OpenHapticsHost, AKilledSimulatorsForceEnds) {
  const char* repeats = std::getenv("TROCAR_REPEATS");
  const int count = repeats != nullptr ? std::max(1, std::atoi(repeats)) : 3;
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    const pid_t victim = StartVictim();
    const host::Stopwatch watch;
    ::kill(victim, SIGKILL);
    ASSERT_TRUE(WaitFor(5, [&] { return !IsPushing(); }));
    times.push_back(1e3 * watch.Seconds());
    ::waitpid(victim, nullptr, 0);
    ASSERT_TRUE(WaitFor(5, [&] { return motors_->devices == 0; })) << "the library is given back, too";
    ASSERT_FALSE(IsPushing());
  }
  std::sort(times.begin(), times.end());
  std::printf(
      "openhaptics, killed: zero at the motors after %.2f ms (median of %d), %.2f (p99), %.2f (longest)\n",
      times[times.size() / 2], count, times[times.size() * 99 / 100], times.back());
}

TEST_F(OpenHapticsHost, AStoppedSimulatorsForceEnds) {
  const pid_t victim = StartVictim();
  ::kill(victim, SIGSTOP);
  EXPECT_TRUE(WaitFor(5, [&] { return !IsPushing(); }));
  device::SystemClock().Sleep(0.05);
  EXPECT_FALSE(IsPushing());
  Kill(victim);
  EXPECT_TRUE(WaitFor(5, [&] { return motors_->devices == 0; }));
}

// the negative control: with the library in the simulator's own process nobody is left to send zero
TEST_F(OpenHapticsHost, WithoutAHostAKilledSimulatorsForceStays) {
  settings_.host.clear();
  const pid_t victim = StartVictim();
  Kill(victim);
  device::SystemClock().Sleep(0.2);
  EXPECT_TRUE(IsPushing());
}

TEST_F(OpenHapticsHost, AHostThatDiesIsALostDeviceThatComesBack) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  ASSERT_TRUE(WaitFor(3, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  ::kill(motors_->process, SIGKILL);
  ASSERT_TRUE(WaitFor(5, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kLost; }));
  EXPECT_EQ(samples[0].status, device::ForceDeviceStatus::kLost);
  EXPECT_EQ(driver.GetState(), device::DriverState::kUnconfigured);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_TRUE(WaitFor(3, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
}

// each way in which the library or its process fails: zero at the motors, a lost device, and back at once. The times are judged
// by a limit that a busy machine keeps; library_faults_tests measures them under a running loop
TEST_F(OpenHapticsHost, EveryFailureOfTheLibraryIsZeroAndALostDevice) {
  constexpr double kGenerous = 0.100;  // [s]
  const auto kill_it = [&](int signal) { return [this, signal] { ::kill(motors_->process, signal); }; };
  const auto fail = [&](StandInFault fault) { return [this, fault] { motors_->fault = fault; }; };
  const std::function<void()> strikes[] = {kill_it(SIGKILL),
                                           kill_it(SIGSTOP),
                                           fail(StandInFault::kCrash),
                                           fail(StandInFault::kSilentScheduler),
                                           fail(StandInFault::kHangingCall),
                                           fail(StandInFault::kSlowCalls)};
  OpenHaptics driver(settings_);
  for (const auto& strike : strikes) {
    SCOPED_TRACE(&strike - strikes);
    motors_->fault = StandInFault::kNone;
    std::array<ForceSample, 2> samples;
    ReadStatus last = ReadStatus::kUnchanged;
    const auto tick = [&] {
      for (int channel = 0; channel < 2; ++channel)
        driver.SendForce(channel, haptics::ForceGate::Make({1.5, 0, 0}));
      last = driver.ReadForceSamples(samples);
      return last == ReadStatus::kLost;
    };
    // half a second without a complaint: nobody ends a library that is well. A busy machine may hold its thread back; the
    // library itself has written down whether it called in time
    bool is_well = false;
    for (int attempt = 0; attempt < 20 && !is_well; ++attempt) {
      motors_->longest_gap = 0;
      const base::Status configured = driver.Configure();
      ASSERT_TRUE(configured.ok()) << configured.error().Text();
      ASSERT_TRUE(driver.Activate().ok());
      is_well = !WaitFor(0.5, tick);
      const long long gap =
          std::max<long long>(motors_->longest_gap, host::NowNanoseconds() - motors_->last_call);
      // without real-time priority its guard may have been held back in place of it, and nobody has seen that
      if (!is_well && IsRealTimePermitted()) {
        ASSERT_GT(gap, device::kLongestCallSilence) << "ended although it called in time";
      }
    }
    ASSERT_TRUE(is_well);
    ASSERT_TRUE(WaitFor(5, [&] { return tick(), IsPushing(); }));
    const pid_t before = motors_->process;
    motors_->fault_process = before;
    const host::Stopwatch watch;
    strike();
    ASSERT_TRUE(WaitFor(5, tick)) << "told in time";
    EXPECT_LE(watch.Seconds(), kGenerous);
    ASSERT_TRUE(WaitFor(5, [&] { return !IsPushing(); }));
    EXPECT_LE(watch.Seconds(), kGenerous);
    EXPECT_TRUE(WaitFor(5, [&] { return motors_->process != before; })) << "another one has taken over";
    const pid_t spare = motors_->process;
    EXPECT_LE(watch.Seconds(), kGenerous);
    EXPECT_EQ(samples[0].status, device::ForceDeviceStatus::kLost);
    EXPECT_EQ(driver.GetState(), device::DriverState::kUnconfigured);
    ASSERT_TRUE(driver.Configure().ok());
    EXPECT_EQ(motors_->process, spare) << "and it is the one from now on";
    ASSERT_TRUE(driver.Cleanup().ok());
  }
  motors_->fault = StandInFault::kNone;
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_EQ(motors_->devices, 2);
  driver.Finalize();
  EXPECT_EQ(motors_->devices, 0);
}

// a spare that cannot open the devices either is ended, and the next opening begins with another process
TEST_F(OpenHapticsHost, ASpareThatFailsIsReplaced) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok() && driver.Activate().ok());
  std::array<ForceSample, 2> samples;
  ASSERT_TRUE(WaitFor(3, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  const pid_t first = motors_->process;
  ::kill(first, SIGSTOP);
  motors_->pending_error = 0x0304;  // for the spare
  ASSERT_TRUE(WaitFor(5, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kLost; }));
  ASSERT_TRUE(WaitFor(5, [&] { return motors_->pending_error == 0; }));
  const base::Status again = driver.Configure();
  ASSERT_TRUE(again.ok()) << again.error().Text();
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_TRUE(WaitFor(3, [&] { return driver.ReadForceSamples(samples) == ReadStatus::kFresh; }));
  EXPECT_EQ(motors_->devices, 2);
  driver.Finalize();
  EXPECT_EQ(motors_->devices, 0);
}

/// The library's process alone, as the simulator speaks to it.
class LibraryProcess : public OpenHapticsHost {
 protected:
  using Reply = device::hd_host::Reply;
  void SetUp() override {
    OpenHapticsHost::SetUp();
    StartProcess();
  }
  void StartProcess() {
    process_.reset();
    auto started = device::Companion::Start(settings_.host, "--openhaptics", sizeof(device::HdHostPage),
                                            base::ErrorCode::kDeviceUnsupported, "");
    ASSERT_TRUE(started.ok());
    process_.emplace(std::move(*started));
    page_of_host_ = new (process_->Page()) device::HdHostPage;
    page_of_host_->mailbox.Clear();
  }
  Reply Ask(const std::string& request) {
    EXPECT_EQ(::send(process_->Socket(), request.data(), request.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(request.size()));
    return TakeReply(10'000);
  }
  /// \return code -1 where none comes
  Reply TakeReply(int milliseconds) {
    Reply reply;
    reply.code = -1;
    pollfd answered{process_->Socket(), POLLIN, 0};
    if (::poll(&answered, 1, milliseconds) == 1) {
      EXPECT_EQ(::recv(process_->Socket(), &reply, sizeof reply, 0), static_cast<ssize_t>(sizeof reply));
    }
    return reply;
  }
  std::string Devices() const { return settings_.hd_file + "\nLeft\nRight\n"; }
  bool Push() {
    return WaitFor(3, [&] {
      page_of_host_->mailbox.Send(0, haptics::ForceGate::Make({1, 0, 0}));
      return IsPushing();
    });
  }
  bool HasReports(double seconds) {
    std::array<ForceSample, 2> samples;
    return WaitFor(seconds, [&] { return page_of_host_->mailbox.Read(samples) == ReadStatus::kFresh; });
  }
  /// \return exit status; -1 where it goes on
  int WaitForEnd() {
    int status = -1;
    if (!WaitFor(10, [&] { return ::waitpid(process_->Process(), &status, WNOHANG) != 0; })) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  static constexpr int kLost = static_cast<int>(base::ErrorCode::kDeviceLost);

  std::optional<device::Companion> process_;
  device::HdHostPage* page_of_host_ = nullptr;
};

TEST_F(LibraryProcess, AnswersEveryRequestAndEndsWithItsSocket) {
  EXPECT_EQ(Ask("start").code, kLost);
  EXPECT_STREQ(
      Ask("start").text,
      "openhaptics: nothing is open; switch the device off and on, and check it with the maker's program");
  EXPECT_EQ(Ask("x").code, kLost) << "no request";
  EXPECT_EQ(Ask("stop").code, 0);
  const Reply missing = Ask("open\n" + std::string(2000, 'x') + "\nLeft\n");
  EXPECT_EQ(missing.code, static_cast<int>(base::ErrorCode::kDeviceUnsupported));
  EXPECT_EQ(std::strlen(missing.text), sizeof missing.text - 1) << "cut, and ended";
  EXPECT_EQ(missing.count, 0u);
  const Reply open = Ask("open\n" + Devices());
  EXPECT_EQ(open.code, 0);
  EXPECT_EQ(open.text[0], 0);
  ASSERT_EQ(open.count, 2u);
  EXPECT_EQ(open.limits[1].max_force, 3.3);
  EXPECT_EQ(motors_->devices, 2);
  EXPECT_EQ(Ask("open\n" + Devices()).code, kLost) << "it is open";
  EXPECT_EQ(Ask("watch\n" + Devices()).code, kLost);
  EXPECT_EQ(Ask("neither").code, kLost);
  EXPECT_EQ(motors_->devices, 2);
  EXPECT_FALSE(HasReports(0.03)) << "not started";
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(Ask("start").code, 0);
    EXPECT_TRUE(HasReports(3));
    EXPECT_TRUE(Push());
    EXPECT_EQ(Ask("stop").code, 0);
    EXPECT_FALSE(IsPushing());
    HasReports(0.01);
    EXPECT_FALSE(HasReports(0.1)) << "stopped, and no reason for the watchdog";
  }
  EXPECT_EQ(Ask("start").code, 0);
  EXPECT_TRUE(Push());
  ::shutdown(process_->Socket(), SHUT_RDWR);
  EXPECT_EQ(WaitForEnd(), 0);
  EXPECT_FALSE(IsPushing());
  EXPECT_EQ(motors_->devices, 0);
  EXPECT_EQ(motors_->misuses, 0);
}

TEST_F(LibraryProcess, BeatsEveryMillisecondBeforeEverybodyElse) {
  ASSERT_TRUE(WaitFor(10, [&] { return page_of_host_->beats > 0; }));
  const std::uint64_t before = page_of_host_->beats;
  const host::Stopwatch watch;
  device::SystemClock().Sleep(0.3);
  const double beats = static_cast<double>(page_of_host_->beats - before);
  EXPECT_GT(beats, 10);
  EXPECT_LT(beats, 1.5e3 * watch.Seconds());
  if (!IsRealTimePermitted()) return;
  sched_param of_host{};
  EXPECT_EQ(::sched_getparam(process_->Process(), &of_host), 0);
  EXPECT_EQ(of_host.sched_priority, sched_get_priority_min(SCHED_FIFO) + 15)
      << "above the loop, below the supervisor";
}

/// A spare beside the process.
class LibrarySpare : public LibraryProcess {
 protected:
  void SetUp() override {
    LibraryProcess::SetUp();
    ASSERT_EQ(Ask("open\n" + Devices()).code, 0);
    ASSERT_EQ(Ask("start").code, 0);
    holder_.swap(process_);
    of_holder_ = page_of_host_;
    StartProcess();
    const int files[] = {holder_->PageFile(), holder_->Handle()};
    ASSERT_TRUE(device::SendFiles(process_->Socket(), "watch\n" + Devices(), files));
    ASSERT_EQ(TakeReply(10'000).code, 0);
  }
  bool HolderPushes() {
    return WaitFor(3, [&] {
      of_holder_->mailbox.Send(0, haptics::ForceGate::Make({1, 0, 0}));
      return IsPushing();
    });
  }

  std::optional<device::Companion> holder_;
  device::HdHostPage* of_holder_ = nullptr;
};

TEST_F(LibrarySpare, TakesThePlaceOfOneThatFailsSendsZeroAndWaits) {
  for (const int signal : {SIGKILL, SIGSTOP}) {
    if (signal == SIGSTOP) {
      process_.reset();
      ASSERT_NO_FATAL_FAILURE(SetUp());
    }
    ASSERT_TRUE(HolderPushes());
    EXPECT_EQ(motors_->process, holder_->Process());
    ::kill(holder_->Process(), signal);
    const Reply taken = TakeReply(10'000);
    EXPECT_EQ(taken.code, 0);
    ASSERT_EQ(taken.count, 2u);
    EXPECT_EQ(taken.limits[0].max_force, 3.3);
    EXPECT_FALSE(IsPushing());
    EXPECT_EQ(motors_->process, process_->Process());
    HasReports(0.01);
    EXPECT_FALSE(HasReports(0.1)) << "until somebody asks for the devices";
    EXPECT_EQ(Ask("start").code, 0);
    EXPECT_TRUE(Push());
    EXPECT_EQ(Ask("stop").code, 0);
    EXPECT_EQ(motors_->misuses, 0);
  }
}

// the simulator is gone: the spare stays until the devices are at zero, by the other or by itself
TEST_F(LibrarySpare, OutlivesTheSimulatorUntilTheDevicesAreAtZero) {
  ASSERT_TRUE(HolderPushes());
  ::kill(holder_->Process(), SIGSTOP);
  ::shutdown(process_->Socket(), SHUT_RDWR);
  EXPECT_EQ(WaitForEnd(), 0);
  EXPECT_FALSE(IsPushing());
  EXPECT_EQ(motors_->devices, 0) << "and given back";
  EXPECT_TRUE(page_of_host_->is_closed);
  EXPECT_FALSE(of_holder_->is_closed);
}

TEST_F(LibrarySpare, LetsOneThatClosesGo) {
  ASSERT_TRUE(HolderPushes());
  const pid_t holder = motors_->process;
  ::shutdown(holder_->Socket(), SHUT_RDWR);
  ASSERT_TRUE(WaitFor(10, [&] { return of_holder_->is_closed.load(); }));
  EXPECT_FALSE(IsPushing());
  EXPECT_EQ(TakeReply(100).code, -1) << "nothing to take over";
  EXPECT_EQ(motors_->process, holder);
  EXPECT_EQ(Ask("open\n" + Devices()).code, 0) << "and it is a process as any other";
  EXPECT_EQ(motors_->process, process_->Process());
}

// what nobody answers for is told: the supervisor goes on where a spare could do nothing
TEST_F(LibrarySpare, SaysThatItCouldNotTakeOver) {
  process_->Kill();
  StartProcess();
  const int files[] = {holder_->PageFile(), holder_->Handle()};
  ASSERT_TRUE(device::SendFiles(process_->Socket(), "watch\nlibHD_that_nobody_has.so\nLeft\n", files));
  ASSERT_EQ(TakeReply(10'000).code, 0);
  // one that is still on the way when the process stops
  ASSERT_TRUE(HolderPushes());
  ::kill(holder_->Process(), SIGKILL);
  EXPECT_EQ(TakeReply(10'000).code, static_cast<int>(base::ErrorCode::kDeviceUnsupported));
  ::shutdown(process_->Socket(), SHUT_RDWR);
  EXPECT_EQ(WaitForEnd(), 1);
  EXPECT_FALSE(page_of_host_->is_closed);
  EXPECT_TRUE(IsPushing()) << "nobody could";
}

// with nobody else to do it, the process itself takes the force away
TEST_F(LibraryProcess, ALibraryThatStandsIsZeroAndTheEndOfItsProcess) {
  double soonest = 1;
  for (int i = 0; i < 20 && soonest > 0.020; ++i) {
    motors_->fault = StandInFault::kNone;
    if (i > 0) {
      ASSERT_NO_FATAL_FAILURE(StartProcess());
    }
    ASSERT_EQ(Ask("open\n" + Devices()).code, 0);
    ASSERT_EQ(Ask("start").code, 0);
    ASSERT_TRUE(Push());
    motors_->fault_process = process_->Process();
    const host::Stopwatch watch;
    motors_->fault = StandInFault::kSilentScheduler;
    ASSERT_EQ(WaitForEnd(), device::hd_host::kLibraryStands);
    EXPECT_GT(watch.Seconds(), 0.010) << "a scheduler may be late";
    EXPECT_FALSE(IsPushing());
    soonest = std::min(soonest, watch.Seconds());
  }
  EXPECT_LE(soonest, 0.020) << "12 ms without a call, and an end that a busy machine delays now and then";
}

TEST_F(OpenHapticsHost, ErrorsOfTheLibraryComeThrough) {
  settings_.hd_file = "libHD_that_nobody_has.so";
  const base::Status missing = OpenHaptics(settings_).Configure();
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, base::ErrorCode::kDeviceUnsupported);
  EXPECT_NE(missing.error().message.find("install"), std::string::npos);
  settings_.hd_file = TROCAR_STAND_IN_HD;
  settings_.names = {"Left", "nobody"};
  OpenHaptics refused(settings_);
  EXPECT_EQ(refused.Configure().error().code, base::ErrorCode::kDeviceLost);
  EXPECT_EQ(motors_->devices, 0) << "the first is given back";
  EXPECT_EQ(FindChild("--openhaptics"), 0) << "and no process stays";
  settings_.names = {"Left\nRight"};
  EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, base::ErrorCode::kDeviceSettings);
  settings_.names = {"Left", ""};
  EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, base::ErrorCode::kDeviceSettings);
  settings_.names = {std::string(4096, 'x')};
  EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, base::ErrorCode::kDeviceSettings);
  // as long as a request may be, and a byte more
  const std::size_t around = settings_.hd_file.size() + 2 + device::hd_host::kWatch.size();
  settings_.names = {std::string(device::hd_host::kLongestRequest - around + 1, 'x')};
  EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, base::ErrorCode::kDeviceSettings);
  settings_.names.front().pop_back();
  EXPECT_TRUE(OpenHaptics(settings_).Configure().ok());
  settings_.names = {std::string(3000, 'x')};
  EXPECT_TRUE(OpenHaptics(settings_).Configure().ok()) << "the stand-in knows every name but one";
  settings_.names = {"Left"};
  settings_.host = "/no/such/trocar-supervisor";
  EXPECT_EQ(OpenHaptics(settings_).Configure().error().code, base::ErrorCode::kDeviceUnsupported);
}

// an error that does not pass: zero, lost, and back
TEST_F(OpenHapticsHost, AnErrorThatDoesNotPassLosesTheDeviceAtZeroForce) {
  OpenHaptics driver(settings_);
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  ASSERT_TRUE(WaitFor(3, [&] {
    driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
    return IsPushing();
  }));
  motors_->pending_error = 0x0302;
  std::array<ForceSample, 2> samples;
  ASSERT_TRUE(WaitFor(3, [&] {
    driver.SendForce(0, haptics::ForceGate::Make({1, 0, 0}));
    return driver.ReadForceSamples(samples) == ReadStatus::kLost;
  }));
  EXPECT_TRUE(WaitFor(3, [&] { return !IsPushing(); }));
  EXPECT_EQ(motors_->misuses, 0);
  EXPECT_TRUE(driver.Configure().ok());
}

}  // namespace
}  // namespace trocar::session
