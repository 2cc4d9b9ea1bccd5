// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/session_input.h"

#include <mutex>
#include <utility>

#include "trocar/record/input_codec.h"
#include "trocar/session/hand_joints.h"

namespace trocar::session {
namespace {

using instrument::Hand;
using instrument::kLeft;
using instrument::kRight;
using scene::HandControls;
using scene::Input;
using simulation::Snapshot;

constexpr Hand kHands[] = {kLeft, kRight};

bool& PedalOf(HandControls& controls, Pedal pedal) {
  switch (pedal) {
    case Pedal::kCut:
      return controls.cut;
    case Pedal::kCoagulate:
      return controls.coagulate;
    case Pedal::kRinse:
      return controls.rinse;
    case Pedal::kAspirate:
      break;
  }
  return controls.aspirate;
}

}  // namespace

SessionInput::SessionInput(const scene::Scene& scene, std::uint64_t next_tick, bool rounds_joints)
    : scene_(&scene),
      rounds_joints_(rounds_joints),
      next_tick_(next_tick),
      device_hands_(scene),
      stylus_hands_(scene) {
  standing_.settings = scene.settings;
  GoHome();
  last_ = standing_;
}

Input SessionInput::Home() const {
  Input home;
  for (const Hand hand : kHands) home.hands[hand] = scene_->instruments[hand].home;
  home.laparoscope = scene_->laparoscope.home;
  home.settings = standing_.settings;
  return home;
}

void SessionInput::GoHome() {
  standing_ = Home();
  presses_ = {};
  device_hands_.Restart();
}

void SessionInput::LiftPedals() {
  for (const Hand hand : kHands) {
    standing_.controls[hand] = {.tool = standing_.controls[hand].tool};
    device_hands_.SetClutch(hand, false);
  }
  presses_ = {};
}

// requests

std::uint64_t SessionInput::MoveHand(device::Channel channel, const instrument::TrocarJoints& joints) {
  const std::lock_guard lock(mutex_);
  (channel == device::kLaparoscope ? standing_.laparoscope : standing_.hands[channel]) = joints;
  return next_tick_;
}

std::uint64_t SessionInput::ChooseTool(Hand hand, std::size_t place) {
  const std::lock_guard lock(mutex_);
  if (place < CountPlaces(hand)) standing_.controls[hand].tool = static_cast<std::uint8_t>(place);
  return next_tick_;
}

std::uint64_t SessionInput::StepTool(Hand hand, int step) {
  const std::lock_guard lock(mutex_);
  if (const int count = static_cast<int>(CountPlaces(hand)); count > 0) {
    std::uint8_t& tool = standing_.controls[hand].tool;
    tool = static_cast<std::uint8_t>((tool + step % count + count) % count);
  }
  return next_tick_;
}

std::uint64_t SessionInput::SetPedal(Hand hand, Pedal pedal, bool is_down) {
  const std::lock_guard lock(mutex_);
  PedalOf(standing_.controls[hand], pedal) = is_down;
  if (is_down) presses_[hand][static_cast<std::size_t>(pedal)] = true;
  return next_tick_;
}

std::uint64_t SessionInput::SetClutch(Hand hand, bool is_held) {
  const std::lock_guard lock(mutex_);
  device_hands_.SetClutch(hand, is_held);
  return next_tick_;
}

std::uint64_t SessionInput::ToggleFreeze(Hand hand) {
  const std::lock_guard lock(mutex_);
  device_hands_.ToggleFreeze(hand);
  return next_tick_;
}

std::uint64_t SessionInput::ReleasePedals() {
  const std::lock_guard lock(mutex_);
  LiftPedals();
  return next_tick_;
}

std::uint64_t SessionInput::CommandAssistant(scene::AssistantCommand command) {
  const std::lock_guard lock(mutex_);
  standing_.assistant = command;
  return next_tick_;
}

std::uint64_t SessionInput::SetSettings(const scene::LiveSettings& settings) {
  const std::lock_guard lock(mutex_);
  standing_.settings = scene::ClampSettings(settings);
  return next_tick_;
}

std::uint64_t SessionInput::GoOnFrom(const Input& input) {
  const std::lock_guard lock(mutex_);
  standing_ = input;
  presses_ = {};
  return next_tick_;
}

std::uint64_t SessionInput::BeginAnew() {
  const std::lock_guard lock(mutex_);
  ++resets_due_;
  GoHome();
  return next_tick_ = 1;
}

// who takes part

void SessionInput::UseDevice(std::unique_ptr<HandDevice> device) {
  const std::lock_guard lock(mutex_);
  device_hands_ = DeviceHands(*scene_);
  device_acts_ = {};
  device_losses_ = 0;
  std::swap(device_, device);
}

void SessionInput::DropDevice() {
  std::unique_ptr<HandDevice> ended;
  const std::lock_guard lock(mutex_);
  std::swap(device_, ended);
}

void SessionInput::UseHaptics(HapticLink& link) {
  const std::lock_guard lock(mutex_);
  haptics_ = &link;
}

void SessionInput::SetGuide(Guide guide) {
  const std::lock_guard lock(mutex_);
  is_guide_over_.store(false);
  std::swap(guide_, guide);
}

void SessionInput::OnDeviceLoss(std::function<void()> on_loss) {
  const std::lock_guard lock(mutex_);
  on_loss_ = std::move(on_loss);
}

// what stands

Input SessionInput::Standing() const {
  const std::lock_guard lock(mutex_);
  return standing_;
}

Input SessionInput::Last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

bool SessionInput::IsHeldByDevice(Hand hand) const {
  const std::lock_guard lock(mutex_);
  return is_held_by_device_[hand];
}

std::string SessionInput::TakeDeviceMessage() {
  const std::lock_guard lock(mutex_);
  return std::exchange(is_device_message_new_, false) ? device_message_ : std::string();
}

// the tick

/// \param may_act   presses count; else they are forgotten
/// \param may_move  hands count
void SessionInput::LookAtDevices(double time, bool may_act, bool may_move) {
  is_held_by_device_ = {};
  if (device_ != nullptr) {
    const DeviceReport& report = device_->Look(time);
    if (report.message != device_message_) {
      device_message_ = report.message;
      is_device_message_new_ = true;
    }
    if (report.losses != device_losses_) {
      device_losses_ = report.losses;
      losses_.fetch_add(1);
      LiftPedals();
      if (on_loss_) on_loss_();
    }
    device_acts_ = report.acts;
    may_act ? device_hands_.Step(report.acts, standing_) : device_hands_.Ignore(report.acts);
    if (may_move) {
      device_hands_.Move(report.samples, report.acts, standing_);
      for (const Hand hand : kHands)
        is_held_by_device_[hand] = report.samples[hand].is_valid && IsFinite(report.samples[hand]);
    }
  }
  const HapticHands* styluses = haptics_ != nullptr ? haptic_hands_.Take(*haptics_) : nullptr;
  stylus_acts_ = styluses != nullptr ? styluses->acts : DeviceActs();
  if (styluses == nullptr) return;
  may_act ? stylus_hands_.Step(stylus_acts_, standing_) : stylus_hands_.Ignore(stylus_acts_);
  for (const Hand hand : kHands) {
    if (!may_move || !styluses->is_driven[hand]) continue;
    standing_.hands[hand] = styluses->joints[hand];
    is_held_by_device_[hand] = true;
  }
}

/// Whoever takes over takes hands, tools and laparoscope where they are.
void SessionInput::Follow(const Snapshot& snapshot, bool is_demonstrated, bool is_hands_only) {
  if (is_demonstrated) {
    for (const Hand hand : kHands) {
      standing_.hands[hand] = snapshot.instruments[hand].joints;
      standing_.controls[hand].tool = snapshot.operation.tools[hand];
    }
  }
  if (standing_.settings.holds_camera || (is_demonstrated && !is_hands_only))
    standing_.laparoscope = snapshot.laparoscope;
}

void SessionInput::Combine(double time, const Guidance& guidance) {
  const Guide& guide = guidance.guide;
  const bool is_guided = guide.source != nullptr;
  if (is_guided && guide.yields_to_devices) {
    standing_.hands = guidance.input.hands;
    if (!guide.is_hands_only) standing_.laparoscope = guidance.input.laparoscope;
  }
  const bool do_devices_count = !is_guided || guide.yields_to_devices;
  LookAtDevices(time, do_devices_count, do_devices_count);
  last_ = standing_;
  for (const Hand hand : kHands) {
    for (std::size_t pedal = 0; pedal < kPedalCount; ++pedal) {
      if (presses_[hand][pedal]) PedalOf(last_.controls[hand], static_cast<Pedal>(pedal)) = true;
    }
  }
  presses_ = {};
  if (do_devices_count) {
    PressPedals(device_acts_, last_);
    PressPedals(stylus_acts_, last_);
  } else if (guide.is_hands_only) {
    last_.hands = guidance.input.hands;
  } else {
    last_ = guidance.input;
    last_.settings = standing_.settings;
    last_.settings.holds_camera = scene_->settings.holds_camera;  // an expert looks for himself
  }
  if (rounds_joints_) record::RoundJoints(last_);
}

Input SessionInput::For(std::uint64_t tick, const Snapshot& before) {
  Guidance guidance;
  {
    const std::lock_guard lock(mutex_);
    // what stands now is of the attempt that begins after the reset
    if (resets_due_ > 0) return last_;
    guidance.guide = guide_;
  }
  // a surgeon may think for a while: nobody waits for that
  if (guidance.guide.source != nullptr) {
    guidance.input = guidance.guide.source->For(tick, before);
    is_guide_over_.store(guidance.guide.source->IsAtEnd());
  }
  is_demonstration_ = guidance.guide.source != nullptr && !guidance.guide.yields_to_devices;
  is_hands_only_ = guidance.guide.is_hands_only;
  const std::lock_guard lock(mutex_);
  if (resets_due_ > 0) return last_;
  next_tick_ = tick + 1;
  Combine(before.time, guidance);
  return last_;
}

void SessionInput::AfterTick(const Snapshot& after) {
  const std::lock_guard lock(mutex_);
  // a demonstration that has just been ended has still made this tick
  if (resets_due_ == 0) Follow(after, is_demonstration_, is_hands_only_);
}

void SessionInput::Wait(const Snapshot& now) {
  const std::lock_guard lock(mutex_);
  if (resets_due_ > 0) return;
  const bool is_demonstrated = guide_.source != nullptr && !guide_.yields_to_devices;
  LookAtDevices(now.time, false, !is_demonstrated);
  Follow(now, is_demonstrated, guide_.is_hands_only);
  last_ = standing_;
}

void SessionInput::Reset() {
  std::shared_ptr<simulation::InputSource> guide;
  {
    const std::lock_guard lock(mutex_);
    if (resets_due_ > 0) {
      --resets_due_;
    } else {
      GoHome();
      next_tick_ = 1;
    }
    guide = guide_.source;
    is_guide_over_.store(false);
    last_ = resets_due_ > 0 ? Home() : standing_;
  }
  if (guide != nullptr) guide->Reset();
}

}  // namespace trocar::session
