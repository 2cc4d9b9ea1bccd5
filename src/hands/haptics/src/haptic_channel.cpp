// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/haptic_channel.h"

#include "guards.h"

namespace trocar::haptics {
namespace {

LocalModelSettings MakeModelSettings(const ChannelSettings& settings) {
  LocalModelSettings made;
  made.tick = settings.tick;
  made.coupling_stiffness =
      CalcCouplingStiffness(settings.map, CalcStiffnessCap(settings.limits, settings.tick));
  return made;
}

}  // namespace

HapticChannel::HapticChannel(const ChannelSettings& settings)
    : settings_(settings),
      guard_(settings.guard),
      model_(MakeModelSettings(settings)),
      gate_(MakeGateSettings(settings.limits, settings.tick)) {}

void HapticChannel::TakePatch(const tissue::LocalPatch& patch, double now) noexcept {
  patch_time_ = now;
  is_patch_healthy_ = patch.is_healthy;
  if (patch.is_healthy) {
    model_.Take(patch);
  } else {
    model_.Clear();
  }
}

const GuardedDevice& HapticChannel::Read(const device::ForceSample& sample, double now) noexcept {
  device_ = guard_.Step(sample, now);
  return device_;
}

ChannelOutput HapticChannel::Act(const math::Pose& X_world_hand, const LoopTiming& timing,
                                 const ChannelConditions& conditions, double now) noexcept {
  ChannelOutput output;
  GateInput gate;
  output.has_pose = device_.has_pose;
  if (device_.has_pose) {
    output.local = model_.Step(X_world_hand);
    gate.force = ToDeviceForce(settings_.map, output.local.force);
  } else {
    model_.Clear();
  }
  gate.velocity = device_.velocity;
  gate.temperature = device_.temperature;
  gate.is_warm = device_.is_warm;
  gate.scale = device_.scale * timing.stiffness_scale;
  gate.fault = device_.fault != Fault::kNone ? device_.fault : timing.fault;
  if (IsOn(Guard::kSupervisor) && conditions.is_supervisor_tripped && gate.fault == Fault::kNone)
    gate.fault = Fault::kSupervisor;
  gate.conditions = {conditions.is_supervised, device_.is_calibrated, conditions.is_pose_confirmed,
                     conditions.is_pedal_held || (device_.buttons & settings_.dead_man_mask) != 0,
                     is_patch_healthy_ && now - patch_time_ <= settings_.max_patch_age};
  output.gate = gate_.Step(gate);
  if (!math::IsFinite(output.local.force)) {
    // what made it so is forgotten; force waits for the next tissue
    model_.Clear();
    is_patch_healthy_ = false;
    output.has_pose = false;
  }
  return output;
}

}  // namespace trocar::haptics
