// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/device_hands.h"

#include "trocar/session/hand_joints.h"

namespace trocar::session {

using instrument::Hand;
using instrument::kLeft;
using instrument::kRight;
using scene::AssistantCommand;
using scene::HandControls;
using scene::Input;

namespace {

using device::HandAct;
using device::HandSample;
using instrument::TrocarJoints;

constexpr Hand kHands[] = {kLeft, kRight};

bool IsUsable(const HandSample& sample) noexcept {
  return sample.is_valid && IsFinite(sample);
}

void ApplyLaparoscope(const HandSample& sample, Input& input) noexcept {
  if (IsUsable(sample)) input.laparoscope = JointsOf(sample);
}

/// From b to a; the jaw, which is where the person's fingers are, is left out.
TrocarJoints WayBetween(const TrocarJoints& a, const TrocarJoints& b) noexcept {
  return {a.pan - b.pan, a.tilt - b.tilt, a.spin - b.spin, a.depth - b.depth, 0.0};
}

}  // namespace

AssistantCommand NextCommand(AssistantCommand now) noexcept {
  constexpr AssistantCommand kNext[] = {AssistantCommand::kRetract, AssistantCommand::kRelax,
                                        AssistantCommand::kRelease, AssistantCommand::kWait};
  return kNext[static_cast<std::size_t>(now)];
}

void PressPedals(const DeviceActs& acts, Input& input) noexcept {
  for (const Hand hand : kHands) {
    HandControls& controls = input.controls[hand];
    controls.cut = controls.cut || acts[hand].IsHeld(HandAct::kCut);
    controls.coagulate = controls.coagulate || acts[hand].IsHeld(HandAct::kCoagulate);
    controls.rinse = controls.rinse || acts[hand].IsHeld(HandAct::kRinse);
    controls.aspirate = controls.aspirate || acts[hand].IsHeld(HandAct::kAspirate);
  }
}

DeviceHands::DeviceHands(const scene::Scene& scene) noexcept {
  for (const Hand hand : kHands) tray_sizes_[hand] = scene.instruments[hand].tray.size();
}

void DeviceHands::Restart() noexcept {
  hands_ = {};
}

void DeviceHands::Step(const DeviceActs& acts, Input& input) noexcept {
  for (const Hand hand : kHands) {
    // right also where another device counts from 0 again: what is less than before is all new
    const auto presses = [&](HandAct act) {
      const std::uint32_t now = acts[hand].CountPresses(act), before = seen_[hand].CountPresses(act);
      return now < before ? now : now - before;
    };
    if (const std::size_t count = tray_sizes_[hand]; count > 0) {
      const std::size_t forward = presses(HandAct::kNextTool) % count;
      const std::size_t back = presses(HandAct::kPreviousTool) % count;
      std::uint8_t& tool = input.controls[hand].tool;
      tool = static_cast<std::uint8_t>((tool + forward + count - back) % count);
    }
    for (std::uint32_t n = presses(HandAct::kAssistant) % 4; n > 0; --n)
      input.assistant = NextCommand(input.assistant);
    if (presses(HandAct::kFreeze) % 2 == 1) ToggleFreeze(hand);
  }
  seen_ = acts;
}

void DeviceHands::Move(const DeviceSamples& samples, const DeviceActs& acts, Input& input) noexcept {
  ApplyLaparoscope(samples[device::kLaparoscope], input);
  for (const Hand hand : kHands) {
    HeldHand& held = hands_[hand];
    if (!IsUsable(samples[hand])) {
      held.is_frozen = held.is_still = false;
      continue;
    }
    const TrocarJoints joints = JointsOf(samples[hand]);
    const bool wants_still =
        held.has_joints && (held.is_frozen || held.has_other_clutch || acts[hand].IsHeld(HandAct::kClutch));
    if (held.is_still && !wants_still) held.offset = WayBetween(held.joints, joints);
    held.is_still = wants_still;
    if (!wants_still) {
      const TrocarJoints& way = held.offset;
      held.joints = {joints.pan + way.pan, joints.tilt + way.tilt, joints.spin + way.spin,
                     joints.depth + way.depth, joints.jaw};
      held.has_joints = true;
    }
    input.hands[hand] = held.joints;
  }
}

}  // namespace trocar::session
