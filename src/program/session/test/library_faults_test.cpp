// SPDX-License-Identifier: Apache-2.0
// A maker's library that fails, and the processes round it, under a running loop with force out: how soon the motors of the
// stand-in are at zero. The motors keep their last force until somebody sends another or opens the device again: a device
// without a watchdog of its own. Built a second time with nobody watching the library's process: then the force must stay.
// TROCAR_REPEATS sets how often each is done (2 by default).
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <string>
#include <thread>

#include "child_processes.h"
#include "force_wire.h"
#include "machine_watch.h"
#include "stand_in_page.h"
#include "trocar/device/open_haptics.h"
#include "trocar/math/random.h"
#include "trocar/session/haptic_loop.h"

namespace trocar::session {

using instrument::kLeft;
using instrument::kRight;

namespace {

/// A loop that presses tissue with both devices of a stand-in library in another process.
class LibraryFaults : public testing::Test {
 protected:
  void SetUp() override {
    motors_->is_led = 1;
    tissue_ = std::thread([this] { FeedTissue(); });
    Start();
    ForceWire::ReadInRealTime();
  }
  void TearDown() override {
    const sched_param ordinary{};
    ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
    loop_.reset();
    is_ending_ = true;
    tissue_.join();
  }
  void Start() {
    device::OpenHapticsSettings library;
    library.hd_file = TROCAR_STAND_IN_HD;
    library.names = {"Left", "Right"};
    library.host = TROCAR_LIBRARY_HOST;
    HapticLoopSettings settings;
    settings.supervisor = TROCAR_SUPERVISOR;
    settings.hands.resize(2);
    settings.hands[0].hand = kLeft;
    for (HapticHand& hand : settings.hands) hand.p_world_port = {0, 0, 0.15};
    loop_.reset();
    auto started = HapticLoop::Start(std::make_unique<device::OpenHaptics>(library), settings, link_);
    ASSERT_TRUE(started.ok()) << started.error().Text();
    loop_ = std::move(*started);
  }
  void FeedTissue() {
    while (!is_ending_) {
      for (const instrument::Hand hand : {kLeft, kRight}) {
        tissue::LocalPatch& patch = link_.patches[hand].Back();
        patch.kind = tissue::LocalPatch::Kind::kLinear;
        patch.is_healthy = true;
        patch.force = {is_pressing_ ? push_.load() : 0.0, 0, 0};
        link_.patches[hand].Publish();
      }
      ::usleep(5000);
    }
  }

  bool IsPushing(std::size_t device) const { return motors_->forces[device][0] != 0; }
  bool IsPushing() const { return IsPushing(0) || IsPushing(1); }

  /// For 20 ms.
  bool PushesWithoutGap() const {
    for (int i = 0; i < 100; ++i) {
      if (!IsPushing(0) || !IsPushing(1)) return false;
      ::usleep(200);
    }
    return true;
  }

  /// Does as the status line asks, until both devices push.
  bool Arm() {
    const host::Stopwatch watch;
    is_pressing_ = false;
    double asked = -1;
    int answered = -1;
    while (watch.Seconds() < 40.0) {
      const HapticStatus& status = loop_->Latest();
      const bool is_new = watch.Seconds() - asked > 0.2;
      if (status.check_pose == haptics::CheckPoseState::kAsking) {
        // all buttons up between one answer and the next
        const bool is_up = status.asked == answered;
        motors_->buttons[0] = is_up && status.asked == kLeft ? 1 : 0;
        motors_->buttons[1] = is_up && status.asked == kRight ? 1 : 0;
        answered = status.asked;
        if (!is_up) ::usleep(50'000);
      } else if (status.check_pose != haptics::CheckPoseState::kConfirmed) {
        motors_->buttons[0] = motors_->buttons[1] = 0;
        if (is_new) loop_->BeginCheckPose(), asked = watch.Seconds();
      } else {
        motors_->buttons[0] = motors_->buttons[1] = 1;
        const bool is_on = status.hands[kLeft].state != haptics::ArmState::kUnarmed &&
                           status.hands[kRight].state != haptics::ArmState::kUnarmed;
        is_pressing_ = is_on;
        if (!is_on && is_new) loop_->RequestArm(), asked = watch.Seconds();
        if (is_on && IsPushing(0) && IsPushing(1)) return true;
      }
      ::usleep(2000);
    }
    ADD_FAILURE() << DescribeHaptics(loop_->Latest());
    return false;
  }

  /// Until the motors are at zero, or the longest that is waited for [s].
  double WaitForZero(std::int64_t struck, double longest, double& absence) {
    std::int64_t now = host::NowNanoseconds(), last = now;
    while (IsPushing() && 1e-9 * static_cast<double>(now - struck) < longest) {
      const timespec moment{0, 100'000};
      ::nanosleep(&moment, nullptr);
      now = host::NowNanoseconds();
      absence = std::max(absence, 1e-9 * static_cast<double>(now - last) - 1e-4);
      last = now;
    }
    return 1e-9 * static_cast<double>(now - struck);
  }

  template <typename Strike>
  void Measure(const char* what, Strike&& strike) {
    ASSERT_NE(loop_, nullptr);
    ZeroTimes times;
    math::Random random(7);
    LoopPeriods periods;
    MachineWatch machine;
    for (int i = 0; i < ForceWire::Repeats(); ++i) {
      if (loop_ == nullptr) Start();
      // hands that come back from a pause of the machine tell nothing of the fault
      int tries = 0;
      do {
        ASSERT_LT(tries++, 20);
        ASSERT_TRUE(Arm());
        ::usleep(static_cast<useconds_t>(random.Uniform(20e3, 40e3)));
        motors_->fault_process = motors_->process.load();
        loop_->ClearTimes();
        machine.Forget();
      } while (!PushesWithoutGap());
      double absence = 0;
      const std::int64_t struck = host::NowNanoseconds();
      strike();
      times.Add(WaitForZero(struck, 5.0, absence), absence);
      ASSERT_FALSE(IsPushing());
      for (int k = 0; k < 100; ++k) {
        ASSERT_FALSE(IsPushing()) << "it came back";
        ::usleep(1000);
      }
      periods.Add(loop_->CalcPeriodPercentile(1.0), machine.LongestAbsence());
      Recover();
    }
    times.ReportAndJudge(std::string(what) + ", library");
    periods.ReportAndJudge(what);
    EXPECT_EQ(motors_->bad_forces, 0) << "not finite, above the clamp or with too fast a rise";
  }
  /// The next one begins with a loop that is well.
  void Recover() {
    motors_->fault = StandInFault::kNone;
    if (FindChild("--watch") == 0) loop_.reset();
  }
  void Strike(StandInFault fault) { motors_->fault = fault; }

  std::unique_ptr<HapticLoop> loop_;
  HapticLink link_;
  StandInPage page_;
  StandInState* const motors_ = page_.Get();
  std::atomic<double> push_{2.0};  // of the tissue [N]

 private:
  std::thread tissue_;
  std::atomic<bool> is_pressing_{false}, is_ending_{false};
};

#ifndef TROCAR_WITHOUT_HOST_WATCH

TEST_F(LibraryFaults, ProcessKilled) {
  Measure("library's process killed", [&] { ::kill(motors_->process, SIGKILL); });
}
TEST_F(LibraryFaults, ProcessStopped) {
  Measure("library's process stopped", [&] { ::kill(motors_->process, SIGSTOP); });
}
TEST_F(LibraryFaults, LibraryCrashes) {
  Measure("library crashed", [&] { Strike(StandInFault::kCrash); });
}
TEST_F(LibraryFaults, SchedulerSilent) {
  Measure("library's scheduler silent", [&] { Strike(StandInFault::kSilentScheduler); });
}
TEST_F(LibraryFaults, CallHangs) {
  Measure("library's call hangs", [&] { Strike(StandInFault::kHangingCall); });
}
TEST_F(LibraryFaults, SlowCalls) {
  Measure("library's calls take 30 ms each", [&] { Strike(StandInFault::kSlowCalls); });
}
TEST_F(LibraryFaults, SupervisorKilled) {
  Measure("supervisor killed", [&] { ::kill(FindChild("--watch"), SIGKILL); });
}
TEST_F(LibraryFaults, SupervisorStopped) {
  pid_t stopped = 0;
  Measure("supervisor stopped", [&] {
    stopped = FindChild("--watch");
    ::kill(stopped, SIGSTOP);
    std::thread([stopped] { ::usleep(150'000), ::kill(stopped, SIGCONT); }).detach();
  });
}

// at the motors, through loop, gate, mailbox and library: as much as the device says that it bears, and never more
TEST_F(LibraryFaults, TheLargestForceIsTheDevices) {
  for (const double nominal : {0.1, 3.3, 8.0, 50.0}) {
    loop_.reset();
    motors_->limits[0] = motors_->limits[1] = nominal;
    motors_->largest = 0;
    push_ = 15.0 * nominal;
    Start();
    const host::Stopwatch watch;
    while (motors_->largest < 0.999 * nominal && watch.Seconds() < 40.0) {
      // a machine that stood still has taken the force away
      if (!IsPushing()) {
        ASSERT_TRUE(Arm()) << nominal;
      }
      ::usleep(1000);
    }
    ::usleep(200'000);
    EXPECT_GE(motors_->largest, 0.999 * nominal) << "the clamp itself";
    EXPECT_LE(motors_->largest, nominal * (1 + 1e-9));
    EXPECT_EQ(motors_->bad_forces, 0);
  }
}

// the person goes on: the device is there again, unarmed, with its check pose to confirm
TEST_F(LibraryFaults, TheDeviceComesBackUnarmed) {
  ASSERT_TRUE(Arm());
  const pid_t before = motors_->process;
  ::kill(before, SIGKILL);
  const host::Stopwatch watch;
  while (loop_->Latest().hands[kRight].reason != haptics::Fault::kPoseUnconfirmed && watch.Seconds() < 20.0)
    ::usleep(1000);
  EXPECT_EQ(loop_->Latest().hands[kRight].state, haptics::ArmState::kUnarmed);
  EXPECT_EQ(loop_->Latest().hands[kRight].reason, haptics::Fault::kPoseUnconfirmed);
  EXPECT_NE(motors_->process, before);
  EXPECT_EQ(motors_->devices, 2);
  EXPECT_TRUE(Arm()) << "and a person can arm again";
}

#else

// The control: with nobody who watches, the motors keep their last force. A machine that stands still takes the force away
// as well, so that one of a few tries has to show it.
TEST_F(LibraryFaults, WithoutAWatchTheForceStays) {
  for (const StandInFault fault :
       {StandInFault::kNone, StandInFault::kSilentScheduler, StandInFault::kHangingCall,
        StandInFault::kSlowCalls, StandInFault::kCrash}) {
    double stayed = 0;
    for (int tries = 0; tries < 10 && stayed <= 0.055; ++tries) {
      if (loop_ == nullptr) Start();
      ASSERT_TRUE(Arm());
      if (!PushesWithoutGap()) continue;
      motors_->fault_process = motors_->process.load();
      double absence = 0;
      const std::int64_t struck = host::NowNanoseconds();
      if (fault == StandInFault::kNone)
        ::kill(motors_->process, SIGSTOP);
      else
        Strike(fault);
      stayed = WaitForZero(struck, 0.060, absence);
      if (fault == StandInFault::kNone) ::kill(motors_->process, SIGKILL);
      Recover();
    }
    EXPECT_GT(stayed, 0.055) << static_cast<int>(fault);
  }
}

#endif

}  // namespace
}  // namespace trocar::session
