// SPDX-License-Identifier: Apache-2.0
/// \file haptic_rig.h  A haptic channel on a bench: a device that reports what a test wants, tissue like a wall, and a
/// watch on everything that is sent.
#pragma once

#include <cmath>
#include <string>

#include "trocar/haptics/haptic_channel.h"

namespace trocar::haptics {

class HapticRig {
 public:
  static constexpr double kTick = 0.001;       // [s]
  static constexpr double kMaxForce = 3.3;     // [N]
  static constexpr double kContinuous = 0.88;  // [N]
  static constexpr double kMaxRise = 0.5;      // [N]

  HapticRig() : HapticRig(MakeLimits()) {}
  explicit HapticRig(const device::ForceLimits& limits)
      : channel(MakeSettings(limits)), max_force(limits.max_force) {
    sample.status = device::ForceDeviceStatus::kOk;
    sample.is_calibrated = true;
    sample.buttons = 1;
    sample.temperature = std::nan("");
    conditions.is_supervised = conditions.is_pose_confirmed = true;
    patch.kind = tissue::LocalPatch::Kind::kLinear;
    patch.is_healthy = true;
    Press(0.0);
  }

  static device::ForceLimits MakeLimits() {
    device::ForceLimits limits;
    limits.max_force = kMaxForce;
    limits.max_continuous_force = kContinuous;
    limits.max_stiffness = 400;
    return limits;
  }
  static ChannelSettings MakeSettings(const device::ForceLimits& limits) {
    ChannelSettings settings;
    settings.limits = limits;
    settings.tick = kTick;
    return settings;
  }

  /// The tissue pushes the tool along +x with so much [N], if the hand stays.
  void Press(double newton) { patch.force = {newton, 0, 0}; }

  /// One tick: the device reports, the tissue comes every eighth tick.
  void Tick() {
    conditions.is_supervisor_tripped = is_tripped;
    now += kTick + lateness;
    if (is_reporting) ++sample.sequence;
    if (ticks++ % 8 == 0 || is_patch_new) channel.TakePatch(patch, now), is_patch_new = false;
    channel.Read(sample, now);
    output = channel.Act({{}, channel.CalcHand()}, loop.Step(lateness), conditions, now);
    lateness = 0;
    Watch();
  }
  void Run(int count) {
    for (int i = 0; i < count; ++i) Tick();
  }
  /// Arms against no force, then lets the tissue push; ends fully armed.
  void ArmAndPress(double newton) {
    Press(0.0);
    Run(20);
    Request();
    Run(2100);
    Press(newton);
    Run(100);
    if (output.gate.state != ArmState::kArmed || !(Size() > 0.0)) Complain("the rig did not arm");
  }
  void Request() {
    channel.RequestArm();
    is_allowed = true;
  }
  /// From here on nothing may be sent until somebody asks again.
  void Forbid() { is_allowed = false; }

  double Size() const { return math::Norm(output.gate.force.Get()); }
  void Complain(const std::string& what) {
    if (complaint.empty()) complaint = what + " at tick " + std::to_string(ticks);
  }

  HapticChannel channel;
  double max_force;  // by its device [N]
  LoopGuard loop;
  device::ForceSample sample;
  tissue::LocalPatch patch;
  ChannelConditions conditions;
  ChannelOutput output;
  double now = 100.0;
  double lateness = 0;  // of the next tick [s]
  long ticks = 0;
  bool is_reporting = true, is_patch_new = false, is_tripped = false;
  bool is_allowed = false;
  bool is_usable = true;  // the limits are those of a device
  std::string complaint;
  math::Vec3 last;

 private:
  /// What must hold in every tick, by its own arithmetic.
  void Watch() {
    const math::Vec3 sent = output.gate.force.Get();
    if (!math::IsFinite(sent)) return Complain("a force that is not finite");
    const double size = math::Norm(sent);
    if (size > 0.0 && !(size <= max_force * (1 + 1e-12)))
      Complain("a force above the clamp: " + std::to_string(size) + " N");
    if (size > 0.0 && !is_allowed) Complain("a force that nobody asked for: " + std::to_string(size) + " N");
    // distance to the way from zero to the last force: to either end, and to the line where its foot lies between
    double rise = std::fmin(size, math::Distance(sent, last));
    const double length = math::Norm(last), along = length > 0.0 ? math::Dot(sent, last) / length : -1.0;
    if (along > 0.0 && along < length) rise = std::fmin(rise, math::Norm(math::Cross(sent, last)) / length);
    if (rise > kMaxRise + 1e-9) Complain("a rise of " + std::to_string(rise) + " N in a tick");
    // the last check is there for what nobody has thought of: here it has nothing to do
    if (output.gate.reason == Fault::kGate && is_usable) Complain("the gate refused its own output");
    last = sent;
  }
};

}  // namespace trocar::haptics
