// SPDX-License-Identifier: Apache-2.0
// D1, D2, D8, D12: how soon after a fault zero force arrives at the device, with the running loop, its clock and its wire.
// TROCAR_REPEATS sets how often each is done (2 by default); the times are printed and judged, by a generous limit in every run and by what
// is promised with TROCAR_SLOW_TESTS=1.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>

#include "force_wire.h"
#include "trocar/math/random.h"
#include "trocar/session/haptic_loop.h"

namespace trocar::session {

using instrument::kRight;

namespace {

using device::SimulatedFault;
using Got = ForceWire::Got;

/// A haptic loop in this process on a wire. The tissue comes from within the device's read, so that a bad force and the
/// moment it comes to be are of the same tick.
class FaultBench {
 public:
  explicit FaultBench(WireKind kind, double max_force = 3.3) : push(0.6 * max_force), wire(kind) {
    device::SimulatedForceSettings simulated;
    simulated.limits = device::MakeTouchLimits();
    simulated.limits.max_force = max_force;
    simulated.limits.max_continuous_force = max_force;
    simulated.wire = wire.Host();
    simulated.path = [this](int, double) {
      Feed();
      return math::Vec3{};
    };
    auto made = std::make_unique<device::SimulatedForceDevice>(simulated);
    device = made.get();
    HapticLoopSettings settings;
    settings.supervisor = TROCAR_SUPERVISOR;
    settings.hands.emplace_back();
    settings.hands[0].p_world_port = {0, 0, 0.15};
    auto started = HapticLoop::Start(std::move(made), settings, link);
    EXPECT_TRUE(started.ok());
    if (started.ok()) loop = std::move(*started);
  }

  /// Does as the status line asks, until force is out.
  bool Arm() {
    is_pressing = false;
    const host::Stopwatch watch;
    while (watch.Seconds() < 20.0) {
      const HapticStatus status = loop->Latest();
      if (status.check_pose != haptics::CheckPoseState::kConfirmed) {
        if (status.check_pose != haptics::CheckPoseState::kAsking)
          loop->BeginCheckPose(), device->SetButtons(0, 0);
        else
          device->SetButtons(0, 1);
      } else if (status.hands[kRight].state == haptics::ArmState::kUnarmed) {
        // the status is up to 50 ms old: it may have said armed before
        is_pressing = false;
        device->SetButtons(0, 1);
        loop->RequestArm();
      } else {
        is_pressing = true;
      }
      const std::int64_t until = host::NowNanoseconds() + 60'000'000;
      while (host::NowNanoseconds() < until) {
        if (wire.Next(0.05) == Got::kForce && is_pressing) return true;
      }
    }
    ADD_FAILURE() << DescribeHaptics(loop->Latest());
    return false;
  }

  /// From the next tick's read on the tissue's force is no number.
  void SpoilForce() { wants_bad = true; }
  std::int64_t Spoiled() const { return spoiled; }  ///< when [ns]

  std::atomic<double> push;  ///< of the tissue [N]
  ForceWire wire;
  HapticLink link;
  device::SimulatedForceDevice* device = nullptr;
  std::unique_ptr<HapticLoop> loop;

 private:
  /// Of the loop's thread.
  void Feed() {
    const bool is_bad = wants_bad.exchange(false);
    if (!is_bad && ++reads % 8 != 0) return;
    tissue::LocalPatch& patch = link.patches[kRight].Back();
    patch.kind = tissue::LocalPatch::Kind::kLinear;
    patch.is_healthy = true;
    patch.force = {is_pressing ? push.load() : 0.0, 0, 0};
    if (is_bad) patch.force.x = std::numeric_limits<double>::quiet_NaN();
    link.patches[kRight].Publish();
    if (is_bad) spoiled = host::NowNanoseconds();
  }
  std::atomic<bool> is_pressing{false}, wants_bad{false};
  std::atomic<std::int64_t> spoiled{0};
  long reads = 0;
};

class FaultTimes : public testing::TestWithParam<WireKind> {
 protected:
  void SetUp() override { bench_ = std::make_unique<FaultBench>(GetParam()); }
  void TearDown() override { SetReader(false); }
  static void SetReader(bool is_first) {
    const sched_param ordinary{};
    if (!is_first || !ForceWire::ReadInRealTime()) ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  }

  /// \param strike  lets the fault happen and returns when [ns]; 0: ask the bench once zero has come
  template <typename Strike>
  void Measure(const char* what, double longest_allowed, Strike&& strike) {
    ASSERT_NE(bench_->loop, nullptr);
    const int repeats = ForceWire::Repeats();
    SetReader(true);
    ZeroTimes times;
    math::Random random(5);
    for (int i = 0; i < repeats; ++i) {
      ASSERT_TRUE(bench_->Arm());
      // at any moment of a tick
      const std::int64_t moment =
          host::NowNanoseconds() + static_cast<std::int64_t>(random.Uniform(2e6, 20e6));
      while (host::NowNanoseconds() < moment - 1'500'000) ASSERT_EQ(bench_->wire.Next(1.0), Got::kForce);
      while (host::NowNanoseconds() < moment) ::usleep(20);
      bench_->wire.ForgetAbsence();
      std::int64_t struck = strike();
      Got got = Got::kForce;
      while (got == Got::kForce) got = bench_->wire.Next(5.0);
      ASSERT_EQ(got, Got::kZero);
      if (struck == 0) struck = bench_->Spoiled();
      times.Add(1e-9 * static_cast<double>(bench_->wire.Arrived() - struck), bench_->wire.LongestAbsence());
      for (int k = 0; k < 20; ++k) ASSERT_NE(bench_->wire.Next(0.002), Got::kForce) << "it came back";
      bench_->device->SetFault(SimulatedFault::kNone);
    }
    times.ReportAndJudge(std::string(what) + ", " + WireName(GetParam()), longest_allowed);
  }
  std::int64_t Inject(SimulatedFault fault) {
    const std::int64_t now = host::NowNanoseconds();
    bench_->device->SetFault(fault);
    return now;
  }

  std::unique_ptr<FaultBench> bench_;
};

TEST_P(FaultTimes, Unplugged) {
  Measure("unplugged", 0.005, [&] { return Inject(SimulatedFault::kUnplugged); });
}

TEST_P(FaultTimes, Silent) {
  Measure("silent", 0.020, [&] { return Inject(SimulatedFault::kSilent); });
}

TEST_P(FaultTimes, BadForce) {
  Measure("bad force", 0.001, [&] {
    bench_->SpoilForce();
    return std::int64_t{0};
  });
}

TEST_P(FaultTimes, SafetySwitchLetGo) {
  Measure("switch let go", 0.005, [&] {
    const std::int64_t now = host::NowNanoseconds();
    bench_->device->SetButtons(0, 0);
    return now;
  });
}

TEST_P(FaultTimes, ReportsThatAlternate) {
  Measure("every other report a jump", 0.010, [&] { return Inject(SimulatedFault::kAlternating); });
}

// on the wire: as much as the device bears, and never more
TEST(ForceOnTheWire, IsTheDevicesLargestAtMost) {
  for (const double nominal : {0.1, 3.3, 8.0, 50.0}) {
    FaultBench bench(WireKind::kSocket, nominal);
    ASSERT_NE(bench.loop, nullptr);
    double largest = 0;
    int at_clamp = 0;
    const host::Stopwatch watch;
    while (watch.Seconds() < 40.0 && at_clamp < 200) {
      // a machine that stood still has taken the force away
      if (bench.wire.Next(1.0) != Got::kForce) {
        bench.push = 0.6 * nominal;
        ASSERT_TRUE(bench.Arm());
        bench.push = 15.0 * nominal;
      }
      largest = std::max(largest, bench.wire.Size());
      at_clamp += bench.wire.Size() >= 0.999 * nominal ? 1 : 0;
    }
    EXPECT_GE(largest, 0.999 * nominal) << "the clamp itself";
    EXPECT_LE(largest, nominal * (1 + 1e-6)) << "floats on the wire";
  }
}

INSTANTIATE_TEST_SUITE_P(On, FaultTimes, testing::Values(WireKind::kTerminal, WireKind::kSocket),
                         [](const auto& wire) {
                           return wire.param == WireKind::kTerminal ? "Terminal" : "Socket";
                         });

}  // namespace
}  // namespace trocar::session
