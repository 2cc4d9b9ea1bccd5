// SPDX-License-Identifier: Apache-2.0
#include "fault_storm.h"

#include <array>
#include <cmath>
#include <limits>

#include "haptic_rig.h"
#include "trocar/math/random.h"

namespace trocar::haptics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kFaultsOfADevice = 500;

/// One hand: the channel with its watch, and behind it a maker's library in its process: it takes the newest force that is
/// no older than 10 ms, and the process is replaced when it has not called for 12 ms.
class Hand {
 public:
  Hand(const device::ForceLimits& limits, bool is_usable) : rig(limits), check_(limits.max_force) {
    rig.is_usable = is_usable;
    rig.patch.jacobian[0] = {-300, 0, 0};
  }

  void Tick() {
    if (is_replaced_) rig.sample.status = device::ForceDeviceStatus::kLost;
    rig.Tick();
    command_ = rig.output.gate.force.Get();
    age_ = 0;
  }
  void Run(int ticks, math::Random& random) {
    for (int i = 0; i < ticks; ++i) {
      Tick();
      // the library's thread is not in step: it skips some ticks and sees others twice
      const double calls = random.Uniform();
      if (calls > 0.1) CallLibrary();
      if (calls > 0.9) CallLibrary();
    }
  }
  /// The library stands still for so many ticks of the loop, and after that is well or replaced.
  void StandStill(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      Tick();
      if (++silent_ > 12) Replace();
    }
    silent_ = 0;
  }
  /// The loop does not come for so many calls of the library: its process hangs or is gone.
  void LoopGone(int calls) {
    for (int i = 0; i < calls; ++i) {
      ++age_;
      CallLibrary();
    }
    if (calls > 10 && math::Norm(motor) > 0.0) rig.Complain("a force that nobody renews");
  }
  /// What was scribbled into the mailbox.
  void Scribble(const math::Vec3& force) {
    const math::Vec3 before = motor;
    command_ = force;
    CallLibrary();
    if (check_.HasRefused()) {
      if (math::Norm(motor) != 0.0) rig.Complain("a refused force reached the motor");
      Replace();
    } else if (device::CalcRise(motor, before) > device::kMaxForceRise + 1e-9) {
      rig.Complain("too fast a rise at the motor");
    }
  }
  void Recover() {
    is_replaced_ = false;
    check_ = device::ForceCheck(rig.max_force);
  }

  HapticRig rig;
  math::Vec3 motor;

 private:
  void Replace() {
    is_replaced_ = true;
    motor = {};
    check_ = device::ForceCheck(rig.max_force);
  }
  void CallLibrary() {
    if (is_replaced_) return;
    const math::Vec3 before = motor;
    motor = check_.Pass(age_ <= 10 ? command_ : math::Vec3{});
    const double size = math::Norm(motor);
    if (size > 0.0 && !(size <= rig.max_force * (1 + 1e-9))) rig.Complain("the motor above the clamp");
    if (!(device::CalcRise(motor, before) <= device::kMaxForceRise + 1e-9))
      rig.Complain("too fast a rise at the motor");
    if (size > 0.0 && !rig.is_usable) rig.Complain("force on a device with wrong limits");
  }

  device::ForceCheck check_;
  math::Vec3 command_;
  int age_ = 0, silent_ = 0;
  bool is_replaced_ = false;
};

/// Log-uniform over what devices bear; each tenth pair says something that none bears.
device::ForceLimits MakeLimits(math::Random& random, bool& is_usable) {
  device::ForceLimits limits = HapticRig::MakeLimits();
  const double inf = std::numeric_limits<double>::infinity();
  const double wrong[] = {kNan, inf,   -inf,  -1.0,
                          0.0,  251.0, 1e308, std::pow(10.0, random.Uniform(1.8, 308.0))};
  is_usable = random.Uniform() < 0.9;
  limits.max_force = is_usable ? std::pow(10.0, random.Uniform(-1.0, std::log10(device::kLargestForceLimit)))
                               : wrong[random.NextWord() % std::size(wrong)];
  const double continuous[] = {0.0, random.Uniform(0.05, 1.0) * limits.max_force, 2.0 * limits.max_force,
                               kNan, -1.0};
  limits.max_continuous_force = continuous[random.NextWord() % std::size(continuous)];
  limits.max_stiffness = std::pow(10.0, random.Uniform(0.0, 5.0));
  limits.damping = random.Uniform() < 0.5 ? 0.0 : random.Uniform(0.0, 2.0);
  return limits;
}

class Storm {
 public:
  explicit Storm(std::uint64_t seed) : random_(seed) {}

  void Run(long faults) {
    while (result.faults < faults && result.complaint.empty()) {
      bool is_usable = true;
      const device::ForceLimits left = MakeLimits(random_, is_usable);
      Hand hands[2] = {{left, is_usable}, {is_usable ? MakeUsable() : left, is_usable}};
      ++result.devices;
      result.refused_devices += !is_usable;
      for (int i = 0; i < kFaultsOfADevice && result.faults < faults; ++i) {
        for (Hand& hand : hands) Live(hand);
        if (!result.complaint.empty()) return;
      }
    }
  }

  FaultStormResult result;

 private:
  bool Chance(double p) { return random_.Uniform() < p; }
  double Any() { return random_.Uniform(-1, 1); }
  device::ForceLimits MakeUsable() {
    bool is_usable = false;
    device::ForceLimits limits;
    while (!is_usable) limits = MakeLimits(random_, is_usable);
    return limits;
  }

  /// A good stretch, in which somebody may ask for force, and a fault.
  void Live(Hand& hand) {
    HapticRig& rig = hand.rig;
    hand.Recover();
    rig.sample.position = {0.003 * Any(), 0.003 * Any(), 0.003 * Any()};
    rig.sample.status = device::ForceDeviceStatus::kOk;
    rig.sample.buttons = 1;
    rig.sample.is_calibrated = true;
    rig.sample.temperature = kNan;
    rig.sample.orientation = {};
    rig.patch.is_healthy = true;
    rig.is_reporting = true;
    rig.conditions = {true, true, false, false};
    rig.is_tripped = false;
    rig.Press(0.0);
    rig.patch.jacobian = {};
    rig.patch.jacobian[0] = {-300, 0, 0};
    rig.patch.X_world_tool.translation = rig.sample.position;
    rig.is_patch_new = true;
    hand.Run(12, random_);
    if (Chance(0.8)) {
      if (rig.is_usable)
        rig.Request();
      else
        rig.channel.RequestArm();  // and nothing is allowed to come
    }
    hand.Run(5, random_);
    const int stretch = Chance(0.02) ? 2200 : 10 + static_cast<int>(40 * random_.Uniform());
    for (int i = 0; i < stretch; ++i) {
      if (Chance(0.05)) rig.Press(1.3 * std::fmin(rig.max_force, 1e300) * Any());
      hand.Run(1, random_);
      ++result.ticks;
      result.armed_ticks += rig.output.gate.state == ArmState::kArmed;
      result.force_ticks += rig.Size() > 0.0;
    }
    Strike(hand);
    hand.Run(1 + static_cast<int>(4 * random_.Uniform()), random_);
    ++result.faults;
    if (!rig.complaint.empty()) {
      result.complaint = rig.complaint + ", fault " + std::to_string(result.faults) + ", " +
                         std::to_string(rig.max_force) + " N";
    }
  }

  /// Those that forbid force do so from their own tick on.
  void Strike(Hand& hand) {
    HapticRig& rig = hand.rig;
    const double huge = std::pow(10.0, random_.Uniform(1.9, 300.0));
    switch (random_.NextWord() % 20) {
      case 0:
        rig.sample.status = device::ForceDeviceStatus::kLost;
        return rig.Forbid();
      case 1:
        rig.is_reporting = false;
        return;
      case 2:
        rig.sample.position.x = Chance(0.5) ? kNan : huge;
        return;
      case 3:
        rig.sample.position += math::Vec3{Any(), Any(), Any()};
        return;
      case 4:
        rig.Press(kNan);
        rig.is_patch_new = true;
        return rig.Forbid();
      case 5:
        rig.Press(huge);
        rig.is_patch_new = true;
        return;
      case 6:
        rig.lateness = random_.Uniform(0.0, 0.018);
        return;
      case 7:
        rig.lateness = random_.Uniform(0.021, 3.0);
        return rig.Forbid();
      case 8:
        rig.is_tripped = true;
        return rig.Forbid();
      case 9:
        rig.sample.temperature = random_.Uniform(0.8, 1.2);
        if (rig.sample.temperature >= 1.0) rig.Forbid();
        return;
      case 10:
        rig.sample.buttons = 0;
        return rig.Forbid();
      case 11:
        rig.sample.is_calibrated = false;
        return rig.Forbid();
      case 12:
        rig.patch.is_healthy = false;
        rig.is_patch_new = true;
        return rig.Forbid();
      case 13:
        rig.patch.jacobian[0] = {huge * Any(), huge * Any(), huge * Any()};
        rig.is_patch_new = true;
        return;
      case 14:
        rig.sample.orientation = Chance(0.5) ? math::Quaternion{0, 0, 0, 0} : math::Quaternion{kNan, 0, 0, 1};
        return;
      case 15:
        rig.conditions.is_supervised = false;
        return rig.Forbid();
      case 16:
        rig.channel.Stop();
        return rig.Forbid();
      case 17:
        return hand.StandStill(1 + static_cast<int>(20 * random_.Uniform()));
      case 18:
        hand.LoopGone(1 + static_cast<int>(20 * random_.Uniform()));
        return;
      default:
        return hand.Scribble(Chance(0.3) ? math::Vec3{kNan, 0, 0} : math::Vec3{huge * Any(), Any(), Any()});
    }
  }

  math::Random random_;
};

}  // namespace

FaultStormResult RunFaultStorm(long faults, std::uint64_t seed) {
  Storm storm(seed);
  storm.Run(faults);
  return storm.result;
}

}  // namespace trocar::haptics
