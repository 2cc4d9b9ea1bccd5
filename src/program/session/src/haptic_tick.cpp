// SPDX-License-Identifier: Apache-2.0
#include "haptic_tick.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"

namespace trocar::session {
namespace {

haptics::CheckPoseSettings MakeCheckPose(const std::vector<HapticHand>& hands) {
  haptics::CheckPoseSettings settings;
  for (std::size_t i = 0; i < hands.size(); ++i) settings.p_device[i] = hands[i].p_device_check;
  return settings;
}

haptics::LoopGuardSettings MakeLoopGuard(double period) {
  haptics::LoopGuardSettings settings;
  settings.period = period;
  return settings;
}

/// Turn of a stylus about its own axis [rad].
double CalcSpin(const math::Quaternion& q) noexcept {
  return 2.0 * std::atan2(q.z, q.w);
}

}  // namespace

HapticTick::HapticTick(device::ForceDriver& driver, const HapticLoopSettings& settings, HapticLink& link)
    : driver_(driver),
      settings_(settings),
      link_(link),
      check_pose_(MakeCheckPose(settings.hands)),
      loop_guard_(MakeLoopGuard(settings.period)),
      buttons_(settings.buttons) {
  TROCAR_ASSERT(static_cast<int>(settings.hands.size()) == driver.GetChannelCount());
  for (std::size_t c = 0; c < settings.hands.size(); ++c) {
    haptics::ChannelSettings channel;
    channel.map = settings.hands[c].map;
    channel.limits = driver.GetLimits(static_cast<int>(c));
    channel.tick = settings.period;
    channel.dead_man_mask = settings.hands[c].dead_man_mask;
    channels_.emplace_back(channel);
    status_.hands[settings.hands[c].hand].is_present = true;
  }
  samples_.resize(channels_.size());
  devices_.resize(channels_.size());
}

/// The shaft goes through the trocar to where the hand is.
math::Pose HapticTick::FindHandPose(std::size_t channel) const noexcept {
  const HapticHand& hand = settings_.hands[channel];
  const math::Vec3 p_world_hand = channels_[channel].CalcHand();
  const auto joints =
      instrument::FindJoints(hand.p_world_port, p_world_hand, CalcSpin(devices_[channel].orientation), 0.0);
  return {instrument::CalcToolPose(hand.p_world_port, joints).rotation, p_world_hand};
}

void HapticTick::Publish(std::size_t channel, const haptics::ChannelOutput& output) noexcept {
  const HapticHand& hand = settings_.hands[channel];
  const haptics::GuardedDevice& device = devices_[channel];
  hands_.is_driven[hand.hand] = output.has_pose;
  if (output.has_pose) {
    // the tool follows as far as the tissue lets it; without a gripper the second button closes the jaws
    const double jaw =
        std::isfinite(device.jaw) ? device.jaw : ((device.buttons & 2U) != 0 ? 0.0 : hand.max_jaw);
    hands_.joints[hand.hand] = instrument::FindJoints(hand.p_world_port, output.local.p_world_tool,
                                                      CalcSpin(device.orientation), jaw);
  }
  hands_.acts[hand.hand] = buttons_.Acts()[hand.hand];
  HapticHandStatus& status = status_.hands[hand.hand];
  status.acts = buttons_.Acts()[hand.hand];
  status.state = output.gate.state;
  status.reason = output.gate.reason;
  status.limits = output.gate.limits;
  status.force = math::Norm(output.gate.force.Get());
  status.max_force = std::max(status.max_force, status.force);
  if (status.state != haptics::ArmState::kUnarmed) ++status.armed_ticks;
  if ((status.limits & haptics::kClamped) != 0) ++status.clamped_ticks;
  status.heat = output.gate.heat;
  status.is_warm = device.is_warm || (output.gate.limits & haptics::kHeatLimited) != 0;
  status.is_switch_held = (device.buttons & hand.dead_man_mask) != 0;
  status.counts = channels_[channel].GetCounts();
}

void HapticTick::Run(const HapticTickInput& input) noexcept {
  if (input.is_device_away) {
    for (device::ForceSample& sample : samples_) sample.status = device::ForceDeviceStatus::kLost;
  } else {
    static_cast<void>(driver_.ReadForceSamples(samples_));
  }
  for (std::size_t c = 0; c < channels_.size(); ++c) devices_[c] = channels_[c].Read(samples_[c], input.now);
  if (input.wants_check_pose) check_pose_.Begin();
  check_pose_.Step(devices_);

  const haptics::LoopTiming timing = loop_guard_.Step(input.lateness);
  const haptics::ChannelConditions conditions{input.is_supervised, check_pose_.IsConfirmed(),
                                              input.is_pedal_held, input.is_supervisor_tripped};
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    if (input.wants_stop) channels_[c].Stop();
    if (input.wants_arm) channels_[c].RequestArm();
    auto& patches = link_.patches[settings_.hands[c].hand];
    if (patches.Update()) channels_[c].TakePatch(patches.Front(), input.now);
    const haptics::ChannelOutput output = channels_[c].Act(FindHandPose(c), timing, conditions, input.now);
    if (!input.is_device_away) driver_.SendForce(static_cast<int>(c), output.gate.force);
    buttons_.See(settings_.hands[c].hand, devices_[c].fault == haptics::Fault::kNone,
                 devices_[c].buttons >> device::kStylusOwnButtons, input.now);
    Publish(c, output);
  }
  link_.hands.Back() = hands_;
  link_.hands.Publish();

  ++status_.ticks;
  if (timing.is_late) ++status_.late_ticks;
  if (timing.fault != haptics::Fault::kNone) ++status_.overruns;
  status_.is_supervised = input.is_supervised;
  status_.check_pose = check_pose_.GetState();
  if (check_pose_.GetAsked() < settings_.hands.size())
    status_.asked = settings_.hands[check_pose_.GetAsked()].hand;
}

}  // namespace trocar::session
