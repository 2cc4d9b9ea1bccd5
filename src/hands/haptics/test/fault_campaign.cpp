// SPDX-License-Identifier: Apache-2.0
#include "fault_campaign.h"

#include <array>
#include <iterator>
#include <limits>
#include <vector>

#include "fault_storm.h"
#include "haptic_rig.h"
#include "trocar/haptics/check_pose.h"
#include "trocar/math/random.h"

namespace trocar::haptics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// After a fault: zero now, the reason told, and zero for good although all is well again.
std::string CheckStaysOff(HapticRig& rig, Fault reason) {
  rig.Forbid();
  if (rig.Size() != 0.0) rig.Complain("force after the fault");
  if (rig.output.gate.reason != reason)
    rig.Complain("reason " + std::string(FindFault(rig.output.gate.reason).name));
  return rig.complaint;
}
std::string CheckNeverArmsItself(HapticRig& rig) {
  rig.sample.status = device::ForceDeviceStatus::kOk;
  rig.sample.buttons = 1;
  rig.sample.temperature = kNan;
  rig.is_reporting = true;
  rig.conditions.is_supervised = rig.conditions.is_pose_confirmed = true;
  rig.is_tripped = false;
  rig.Press(0.1);
  rig.Forbid();
  rig.Run(3000);
  rig.Request();
  rig.Run(2200);
  if (rig.output.gate.state != ArmState::kArmed) rig.Complain("no force after a new request");
  return rig.complaint;
}

std::string NotAskedFor() {
  HapticRig rig;
  rig.Press(0.2);
  rig.Run(3000);
  rig.Press(2.0);
  rig.Run(100);
  // a request against pressed tissue is refused and lapses
  rig.channel.RequestArm();
  rig.Run(600);
  if (rig.output.gate.reason != Fault::kForceAtArming) rig.Complain("armed against pressed tissue");
  rig.Press(0.0);
  rig.Run(3000);
  return rig.complaint;
}

std::string Ramp() {
  HapticRig rig;
  rig.Run(20);
  rig.Request();
  rig.Run(4);
  if (rig.output.gate.state != ArmState::kRamping) rig.Complain("not ramping after four good ticks");
  rig.Press(2.0);
  rig.Run(500);
  if (rig.Size() < 0.3 || rig.Size() > 0.6) rig.Complain("not a quarter of the force after 0.5 s");
  rig.Run(1600);
  if (std::fabs(rig.Size() - 2.0) > 0.01 || rig.output.gate.state != ArmState::kArmed)
    rig.Complain("not the whole force after 2 s");
  // after a short fault 0.5 s
  rig.sample.buttons = 0;
  rig.Tick();
  rig.sample.buttons = 1;
  rig.Press(0.0);
  rig.Run(50);
  rig.Request();
  rig.Run(520);
  if (rig.output.gate.state != ArmState::kArmed) rig.Complain("not armed 0.5 s after a short fault");
  return rig.complaint;
}

/// At the nominal force of a small device, a Touch, a Phantom and the strongest that is believed.
std::string Clamp() {
  for (const double nominal : {0.1, 3.3, 8.0, 50.0}) {
    device::ForceLimits limits = HapticRig::MakeLimits();
    limits.max_force = limits.max_continuous_force = nominal;
    HapticRig rig(limits);
    // into the clamp along each axis and askew; the rig watches that nothing above it is ever sent
    for (const math::Vec3& way :
         {math::Vec3{1, 0, 0}, math::Vec3{0, -1, 0}, math::Vec3{0, 0, 1}, math::Vec3{-0.6, 0.64, -0.48}}) {
      if (rig.output.gate.state != ArmState::kArmed) rig.ArmAndPress(0.5 * nominal);
      rig.patch.force = 15.0 * nominal * way;
      rig.is_patch_new = true;
      rig.Run(300);
      if (!(rig.Size() >= 0.999 * nominal)) rig.Complain("not at the clamp");
      if ((rig.output.gate.limits & kClamped) == 0) rig.Complain("the clamp is not told");
    }
    if (!rig.complaint.empty()) return rig.complaint + ", " + std::to_string(nominal) + " N";
  }
  return {};
}

std::string Rise() {
  HapticRig rig;
  rig.ArmAndPress(0.1);
  rig.Press(-3.0);
  rig.patch.jacobian = {};
  rig.is_patch_new = true;
  rig.Run(20);
  rig.Press(3.0);
  rig.is_patch_new = true;
  rig.Run(20);
  if (rig.output.local.force.x < 2.9) rig.Complain("the rig did not press");
  return rig.complaint;
}

std::string D1Lost() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  rig.sample.status = device::ForceDeviceStatus::kLost;
  rig.Tick();
  const std::string wrong = CheckStaysOff(rig, Fault::kDeviceLost);
  return wrong.empty() ? CheckNeverArmsItself(rig) : wrong;
}

/// A device that is open and has not reported yet, at first and after a loss: silent, so the check pose that has begun stays.
std::string D2NotReportedYet() {
  DeviceGuard guard;
  CheckPose check{CheckPoseSettings{}};
  device::ForceSample sample;
  sample.status = device::ForceDeviceStatus::kOk;
  check.Begin();
  for (int tick = 0; tick < 5; ++tick) {
    const std::array devices = {guard.Step(sample, 0.001 * tick)};
    if (devices[0].has_pose) return "a pose that nobody reported";
    if (devices[0].fault != Fault::kSilent) return "no report yet is not called silence";
    check.Step(devices);
    if (check.GetState() != CheckPoseState::kAsking) return "the check pose was taken back";
  }
  sample.status = device::ForceDeviceStatus::kLost;
  static_cast<void>(guard.Step(sample, 0.010));
  sample.status = device::ForceDeviceStatus::kOk;
  if (guard.Step(sample, 0.011).has_pose) return "a pose that nobody reported, after a loss";
  return {};
}

std::string D2Silent() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  const double before = rig.Size();
  rig.is_reporting = false;
  rig.Run(9);
  if (std::fabs(rig.Size() - before) > 1e-6) rig.Complain("a short gap is not bridged");
  for (int i = 9; i < 20; ++i) {
    const double last = rig.Size();
    rig.Tick();
    if (rig.Size() > last + 1e-6) rig.Complain("the force grows while the device is silent");
  }
  const std::string wrong = CheckStaysOff(rig, Fault::kSilent);
  return wrong.empty() ? CheckNeverArmsItself(rig) : wrong;
}

std::string D4Nonsense() {
  for (const int kind : {0, 1, 2, 3}) {
    HapticRig rig;
    rig.ArmAndPress(2.0);
    const device::ForceSample good = rig.sample;
    const auto spoil = [&] {
      if (kind == 0) rig.sample.position.y = kNan;
      if (kind == 1) rig.sample.position.z = 40.0;
      if (kind == 2) rig.sample.orientation.w = 0.5;
      if (kind == 3) rig.sample.orientation.x = -std::numeric_limits<double>::infinity();
    };
    const auto restore = [&] {
      rig.sample.position = good.position;
      rig.sample.orientation = good.orientation;
    };
    const double before = rig.Size();
    spoil();
    rig.Run(2);
    if (std::fabs(rig.Size() - before) > 1e-6) rig.Complain("a bad report changed the force");
    restore();
    rig.Run(5);
    if (rig.output.gate.state != ArmState::kArmed) rig.Complain("two bad reports were a fault");
    spoil();
    rig.Run(3);
    const std::string wrong = CheckStaysOff(rig, Fault::kBadSamples);
    if (!wrong.empty()) return wrong;
    restore();
    const std::string later = CheckNeverArmsItself(rig);
    if (!later.empty()) return later;
  }
  return {};
}

std::string D5Jump() {
  HapticRig rig;
  rig.patch.jacobian[0] = {-300, 0, 0};
  rig.ArmAndPress(1.0);
  const double before = rig.Size();
  // a glitch into the tissue and back, and a quaternion that flips its sign
  rig.sample.position = {-0.05, 0, 0};
  rig.Tick();
  if (std::fabs(rig.Size() - before) > 1e-9) rig.Complain("a jump made a force");
  rig.sample.position = {};
  rig.sample.orientation = {-1, 0, 0, 0};
  rig.Run(5);
  if (rig.output.gate.state != ArmState::kArmed || rig.channel.GetCounts().jumps != 1)
    rig.Complain("a sign flip or a glitch of one report counts as a jump that stays");
  // a jump that stays
  rig.sample.position = {-0.05, 0, 0};
  rig.Run(3);
  const std::string wrong = CheckStaysOff(rig, Fault::kJump);
  if (!wrong.empty()) return wrong;
  rig.patch.X_world_tool.translation = rig.sample.position;
  return CheckNeverArmsItself(rig);
}

/// To and fro between two places, in each n-th report: no force of a jump, and none at all from the third on.
std::string D5Alternating() {
  for (int period = 2; period <= 10; ++period) {
    HapticRig rig;
    rig.patch.jacobian[0] = {-300, 0, 0};
    rig.ArmAndPress(1.0);
    const double before = rig.Size();
    int ticks = 0;
    for (; ticks < 60 && rig.output.gate.state == ArmState::kArmed; ++ticks) {
      if (std::fabs(rig.Size() - before) > 1e-9) rig.Complain("a jump made a force");
      rig.sample.position = {ticks % period == 0 ? -0.05 : 0.0, 0, 0};
      rig.Tick();
    }
    if (ticks != 2 * period + 1) rig.Complain("force after " + std::to_string(ticks) + " ticks of jumps");
    const std::string wrong = CheckStaysOff(rig, Fault::kJump);
    if (!wrong.empty()) return wrong;
    rig.sample.position = {};
    const std::string later = CheckNeverArmsItself(rig);
    if (!later.empty()) return later;
  }
  return {};
}

std::string D8NotFinite() {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    HapticRig rig;
    rig.ArmAndPress(2.0);
    rig.Press(bad);
    rig.is_patch_new = true;
    rig.Tick();
    const std::string wrong = CheckStaysOff(rig, Fault::kForceNotFinite);
    if (!wrong.empty()) return wrong;
    const std::string later = CheckNeverArmsItself(rig);
    if (!later.empty()) return later;
  }
  return {};
}

std::string D8Implausible() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  rig.Press(5000.0);
  for (int i = 0; i < 3; ++i) rig.is_patch_new = true, rig.Tick();
  rig.Run(20);
  const std::string wrong = CheckStaysOff(rig, Fault::kForceImplausible);
  return wrong.empty() ? CheckNeverArmsItself(rig) : wrong;
}

/// Whatever a device says that it bears: with usable limits the promises hold, with others no force comes.
std::string AnyLimits() {
  math::Random random(26);
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<double> forces = {kNan, inf, -inf, -3.3, 0.0,  -0.0,  1e-300,
                                0.1,  0.5, 3.3,  40.0, 50.0, 251.0, 1e308};
  for (int i = 0; i < 300; ++i)
    forces.push_back(std::pow(10.0, random.Uniform(-1.0, i % 2 == 0 ? 2.7 : 308.0)));
  for (const double force : forces) {
    device::ForceLimits limits = HapticRig::MakeLimits();
    limits.max_force = force;
    const double others[] = {0.0, 0.25 * force, force, 2.0 * force, kNan, inf, -1.0};
    limits.max_continuous_force = others[random.NextWord() % std::size(others)];
    const bool is_usable = force >= device::kSmallestForceLimit && force <= device::kLargestForceLimit;
    limits.max_stiffness = std::pow(10.0, random.Uniform(1.0, 5.0));
    HapticRig rig(limits);
    rig.is_usable = is_usable;
    rig.Run(20);
    if (rig.is_usable)
      rig.Request();
    else
      rig.channel.RequestArm();
    // a person who asks again and again, and tissue that pushes with all that is plausible
    for (int i = 0; i < 40; ++i) {
      rig.Press(random.Uniform(-1.0, 1.0) * std::fmin(7.0 * force, 1e300));
      rig.patch.force.y = random.Uniform(-1.0, 1.0) * std::fmin(force, 1e300);
      if (i < 20) rig.Press(0.0), rig.patch.force.y = 0;
      rig.is_patch_new = true;
      if (!rig.is_usable) rig.channel.RequestArm();
      rig.Run(i < 20 ? 110 : 10);
    }
    if (rig.complaint.empty() && rig.is_usable && !(rig.Size() > 0.0))
      rig.Complain("no force: " + std::string(FindFault(rig.output.gate.reason).name) + ", " +
                   std::to_string(math::Norm(rig.output.local.force)) + " N wanted");
    if (!rig.is_usable && rig.output.gate.reason != Fault::kGate) rig.Complain("wrong limits are not named");
    if (!rig.complaint.empty())
      return rig.complaint + ", limits " + std::to_string(force) + " N, " +
             std::to_string(limits.max_continuous_force) + " N";
  }
  return {};
}

std::string D9Overrun() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  rig.lateness = 0.002;
  rig.Tick();
  if (std::fabs(rig.Size() - 2.0) > 0.01) rig.Complain("one late tick changed the force");
  rig.lateness = 0.008;
  rig.Tick();
  if (std::fabs(rig.Size() - 1.0) > 0.1) rig.Complain("8 ms late did not soften");
  rig.Run(700);
  if (std::fabs(rig.Size() - 2.0) > 0.01) rig.Complain("the stiffness did not come back");
  rig.lateness = 0.025;
  rig.sample.sequence += 20;
  rig.Tick();
  // the stall also made the device's last report old: either names it
  rig.Forbid();
  if (rig.Size() != 0.0 || rig.output.gate.state != ArmState::kUnarmed) rig.Complain("force after a stall");
  return rig.complaint.empty() ? CheckNeverArmsItself(rig) : rig.complaint;
}

std::string D10Supervisor() {
  {
    HapticRig rig;
    rig.ArmAndPress(2.0);
    rig.is_tripped = true;
    rig.Tick();
    const std::string wrong = CheckStaysOff(rig, Fault::kSupervisor);
    if (!wrong.empty()) return wrong;
    const std::string later = CheckNeverArmsItself(rig);
    if (!later.empty()) return later;
  }
  HapticRig rig;
  rig.conditions.is_supervised = false;
  rig.Run(20);
  rig.channel.RequestArm();
  rig.Press(0.2);
  rig.Run(3000);
  return rig.complaint;
}

std::string D11Heat() {
  HapticRig rig;
  rig.ArmAndPress(3.0);
  rig.Run(80'000);
  if (rig.Size() > 1.05 * HapticRig::kContinuous) rig.Complain("a steady force above what the motors bear");
  if (rig.Size() < 0.8 * HapticRig::kContinuous) rig.Complain("the derating took too much");
  if ((rig.output.gate.limits & kHeatLimited) == 0) rig.Complain("the derating is not told");
  rig.sample.status = device::ForceDeviceStatus::kWarm;
  rig.Run(5);
  if (rig.Size() > 0.5 * HapticRig::kContinuous + 1e-9) rig.Complain("a warm device is not spared");
  rig.sample.status = device::ForceDeviceStatus::kOk;
  rig.sample.temperature = 1.01;
  rig.Tick();
  const std::string wrong = CheckStaysOff(rig, Fault::kOverheated);
  return wrong.empty() ? CheckNeverArmsItself(rig) : wrong;
}

std::string D12DeadMan() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  rig.sample.buttons = 0;
  rig.Tick();
  const std::string wrong = CheckStaysOff(rig, Fault::kDeadMan);
  return wrong.empty() ? CheckNeverArmsItself(rig) : wrong;
}

/// The check pose with devices that move as told; returns the state it ends in.
CheckPoseState RunCheckPose(bool are_swapped, math::Vec3 offset) {
  CheckPoseSettings settings;
  settings.p_device[0] = settings.p_device[1] = {0, -0.05, 0.02};
  settings.ticks = 50;
  CheckPose check(settings);
  std::array<GuardedDevice, 2> devices;
  for (GuardedDevice& device : devices)
    device.has_pose = device.is_calibrated = true, device.fault = Fault::kNone;
  check.Begin();
  for (std::size_t hand = 0; hand < 2; ++hand) {
    GuardedDevice& moved = devices[are_swapped ? 1 - hand : hand];
    check.Step(devices);
    for (int i = 0; i <= 100; ++i) {
      moved.position = (i / 100.0) * (settings.p_device[hand] + offset);
      check.Step(devices);
    }
    moved.buttons = 1;
    for (int i = 0; i < 60; ++i) check.Step(devices);
    moved.buttons = 0;
  }
  return check.GetState();
}

std::string D13CheckPose() {
  if (RunCheckPose(false, {}) != CheckPoseState::kConfirmed) return "the right devices are not confirmed";
  if (RunCheckPose(true, {}) != CheckPoseState::kWrongDevice) return "swapped devices are confirmed";
  if (RunCheckPose(false, {0.03, 0, 0}) == CheckPoseState::kConfirmed)
    return "a device that is 30 mm out of calibration is confirmed";
  for (const bool is_pose : {false, true}) {
    HapticRig rig;
    rig.conditions.is_pose_confirmed = is_pose;
    rig.sample.is_calibrated = !is_pose;
    rig.Run(20);
    rig.channel.RequestArm();
    rig.Press(0.2);
    rig.Run(3000);
    if (!rig.complaint.empty()) return rig.complaint;
    if (rig.output.gate.reason != (is_pose ? Fault::kNotCalibrated : Fault::kPoseUnconfirmed))
      return "the missing condition is not named";
  }
  return {};
}

std::string D14Flood() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  for (int i = 0; i < 200; ++i) {
    rig.sample.sequence += 9;  // nine of ten reports were overwritten before they were read
    rig.Tick();
  }
  if (rig.output.gate.state != ArmState::kArmed || rig.channel.GetCounts().bad != 0)
    rig.Complain("a flood of good reports is a fault");
  return rig.complaint;
}

std::string Overspeed() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  // the force drives the device off: 20 m/s^2 up to beyond the speed of a runaway
  rig.patch.jacobian = {};
  double speed = 0;
  while (speed < 1.95) {
    speed += 0.02;
    rig.sample.position.x += 0.001 * speed;
    rig.Tick();
  }
  if (rig.Size() > 0.3) rig.Complain("the force drives a fast device on");
  return rig.complaint;
}

std::string SimulationStands() {
  HapticRig rig;
  rig.ArmAndPress(2.0);
  rig.patch.is_healthy = false;
  rig.is_patch_new = true;
  rig.Tick();
  const std::string wrong = CheckStaysOff(rig, Fault::kSimulation);
  if (!wrong.empty()) return wrong;
  rig.patch.is_healthy = true;
  return CheckNeverArmsItself(rig);
}

/// Faults of every kind in both hands, on one pair of devices after another, into channels that are armed again and again.
std::string AnyFault() {
  const FaultStormResult storm = RunFaultStorm(40'000, 20'261'121);
  if (!storm.complaint.empty()) return storm.complaint;
  if (storm.armed_ticks < 20'000 || storm.force_ticks < 200'000)
    return "the storm was hardly ever armed: " + std::to_string(storm.armed_ticks) + ", " +
           std::to_string(storm.force_ticks);
  return {};
}

constexpr CampaignRow kRows[] = {
    {"not asked for", NotAskedFor},
    {"ramp", Ramp},
    {"clamp", Clamp},
    {"rise", Rise},
    {"D1 lost", D1Lost},
    {"D2 silent", D2Silent},
    {"D2 not reported yet", D2NotReportedYet},
    {"D4 nonsense", D4Nonsense},
    {"D5 jump", D5Jump},
    {"D5 alternating", D5Alternating},
    {"D8 not finite", D8NotFinite},
    {"D8 implausible", D8Implausible},
    {"any limits", AnyLimits},
    {"D9 overrun", D9Overrun},
    {"D10 supervisor", D10Supervisor},
    {"D11 heat", D11Heat},
    {"D12 dead man", D12DeadMan},
    {"D13 check pose", D13CheckPose},
    {"D14 flood", D14Flood},
    {"overspeed", Overspeed},
    {"S1 simulation", SimulationStands},
    {"any fault", AnyFault},
};

}  // namespace

std::span<const CampaignRow> CampaignRows() {
  return kRows;
}

}  // namespace trocar::haptics
