// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/session_control.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "trocar/presenter/guides.h"
#include "trocar/presenter/level_horizon.h"
#include "trocar/presenter/pointer_map.h"
#include "trocar/session/hand_joints.h"

namespace trocar::presenter {
namespace {

using device::Channel;
using device::HandSample;
using instrument::TrocarJoints;
using session::JointsOf;
using session::SampleOf;

constexpr Channel kChannels[] = {device::kLeftHand, device::kRightHand, device::kLaparoscope};

/// Where the laparoscope looks at, ahead of its lens: sets how fast it follows the pointer [m].
constexpr double kLookDistance = 0.08;
/// Part of a shaft that stays outside for the hand [m].
constexpr double kHandlePart = 0.03;
/// A mouse feels no resistance: its hand goes at most so far ahead of the tool that something stops, and is then taken back
/// a little, so that turning round answers at once [m].
constexpr double kMostLead = 0.025, kLeadKept = 0.020;
/// The wheel's snap leaves so much between the tip and what lies ahead [m].
constexpr double kSnapGap = 0.001;
/// A scope bent by less than this is straight [rad].
constexpr double kStraight = 1e-6;

device::MouseKeyboardSettings DeviceSettings(const scene::Scene& scene) {
  device::MouseKeyboardSettings settings;
  settings.shaft_length = scene.instruments[0].tool.shaft_length;
  for (const scene::InstrumentSetup& setup : scene.instruments)
    settings.shaft_length = std::min(settings.shaft_length, setup.tool.shaft_length);
  for (int channel = 0; channel < device::kChannelCount; ++channel) {
    device::HandLimits& limits = settings.limits[channel];
    limits.max_depth = std::min(limits.max_depth, settings.shaft_length - kHandlePart);
    if (channel < instrument::kHandCount) limits.max_jaw = scene.instruments[channel].tool.max_jaw;
  }
  // a laparoscope may look in from right below the wall
  settings.limits[device::kLaparoscope].min_depth = 0.005;
  return settings;
}

}  // namespace

bool IsCameraTask(const scene::Scene& scene) {
  if (!scene.task || scene.task->goals.empty()) return false;
  for (const scene::Goal& goal : scene.task->goals) {
    for (const scene::Condition& step : goal.steps) {
      if (step.kind != scene::ConditionKind::kCameraSees) return false;
    }
  }
  return true;
}

base::Result<std::unique_ptr<SessionControl>> SessionControl::Make(simulation::Simulation simulation,
                                                                   const session::SessionOptions& options) {
  const device::MouseKeyboardSettings settings = DeviceSettings(simulation.GetScene());
  auto session = session::Session::Open(std::move(simulation), options);
  if (!session) return session.error();
  std::unique_ptr<SessionControl> control(new SessionControl(std::move(*session), settings));
  if (const base::Status status = control->device_.Configure(); !status) return status.error();
  if (const base::Status status = control->device_.Activate(); !status) return status.error();
  control->PlaceAtHome();
  control->is_camera_task_ = presenter::IsCameraTask(control->GetScene());
  control->has_camera_ = control->is_camera_task_;
  control->HoldLaparoscope(false);
  control->RestoreSettings();
  return control;
}

SessionControl::SessionControl(std::unique_ptr<session::Session> session,
                               const device::MouseKeyboardSettings& settings)
    : session_(std::move(session)), device_(settings) {}

void SessionControl::PlaceAtHome() {
  const scene::Scene& scene = GetScene();
  device_.ReleaseAll();
  device_.Place(device::kLeftHand, SampleOf(scene.instruments[instrument::kLeft].home));
  device_.Place(device::kRightHand, SampleOf(scene.instruments[instrument::kRight].home));
  device_.Place(device::kLaparoscope, SampleOf(scene.laparoscope.home));
  for (const Channel channel : kChannels) SendHand(channel);
}

/// Asks for a hand where mouse and keys have it.
void SessionControl::SendHand(Channel channel) {
  std::array<HandSample, device::kChannelCount> samples;
  device_.Read(samples);
  if (samples[channel].is_valid) session_->Input().MoveHand(channel, JointsOf(samples[channel]));
  TakeStanding();
}

void SessionControl::GoOnFrom(const scene::Input& last) {
  const simulation::Snapshot& snapshot = Look();
  device_.ReleaseAll();
  for (const Channel hand : {device::kLeftHand, device::kRightHand})
    device_.Place(hand, SampleOf(snapshot.instruments[hand].joints));
  device_.Place(device::kLaparoscope, SampleOf(snapshot.laparoscope));
  session_->Input().GoOnFrom(last);
  ReleasePedals();
  for (const Channel channel : kChannels) SendHand(channel);
}

void SessionControl::LetExpertGoOn() {
  if (!HasScript() || is_demonstration_) return;
  is_demonstration_ = true;
  device_.ReleaseAll();
  ReleasePedals();
  session_->Demonstrate();
}

const simulation::Snapshot& SessionControl::Advance(double dt) {
  const simulation::Snapshot& snapshot = Look();
  if (const std::uint64_t losses = session_->Input().DeviceLosses(); losses != device_losses_) {
    device_losses_ = losses;
    device_.ReleaseAll();  // the session has paused and lifted the pedals
  }
  TakeStanding();
  AdvanceMouse(snapshot, IsPaused() ? 0.0 : dt);
  return snapshot;
}

void SessionControl::AdvanceMouse(const simulation::Snapshot& snapshot, double dt) {
  std::array<HandSample, device::kChannelCount> before, after;
  device_.Read(before);
  if (!IsPaused()) {
    LimitLead(snapshot);
    const math::Pose X_world_view = CalcView(snapshot);
    device_.Read(after);
    for (const Channel channel : kChannels) {
      const TrocarJoints joints = JointsOf(after[channel]);
      const math::Vec3 away =
          channel == device::kLaparoscope
              ? math::Vec3{0, 0, -1}
              : CalcSightLine(X_world_view,
                              instrument::CalcToolPose(GetScene().instruments[channel].p_world_port, joints)
                                  .translation);
      device_.SetPointerMap(channel, CalcPointerMap(joints, X_world_view, away));
    }
    const Channel chosen = device_.GetChosen();
    const math::Vec3 p_world_followed = chosen == device::kLaparoscope
                                            ? X_world_view * math::Vec3{0, 0, -kLookDistance}
                                            : snapshot.instruments[chosen].X_world_tool.translation;
    device_.SetMetresPerPixel(CalcMetresPerPixel(X_world_view, p_world_followed, field_of_view_, pixels_));
    device_.Advance(dt);
    wheel_under_way_ *= std::exp(-dt / device::MouseKeyboardSettings().wheel_time);
  }
  device_.Read(after);
  for (const Channel channel : kChannels) {
    const bool is_hand = channel != device::kLaparoscope;
    const bool is_others =
        is_hand &&
        (is_demonstration_ || session_->Input().IsHeldByDevice(static_cast<instrument::Hand>(channel)));
    const TrocarJoints& standing = is_hand ? input_.hands[channel] : input_.laparoscope;
    if (!is_others && JointsOf(before[channel]) != JointsOf(after[channel])) {
      SendHand(channel);
    } else if (JointsOf(after[channel]) != standing) {
      device_.Place(channel, SampleOf(standing));  // so that taking over makes no jump
    }
  }
}

math::Pose SessionControl::CalcView(const simulation::Snapshot& snapshot) const {
  const bool is_straight = std::fabs(GetScene().laparoscope.view_angle) < kStraight;
  return is_straight ? LevelHorizon(snapshot.X_world_laparoscope) : snapshot.X_world_laparoscope;
}

void SessionControl::LimitLead(const simulation::Snapshot& snapshot) {
  const Channel chosen = device_.GetChosen();
  if (chosen == device::kLaparoscope || is_demonstration_ ||
      session_->Input().IsHeldByDevice(static_cast<instrument::Hand>(chosen)))
    return;
  const simulation::InstrumentSnapshot& seen = snapshot.instruments[chosen];
  const math::Vec3 lead = seen.X_world_device.translation - seen.X_world_tool.translation;
  const double length = math::Norm(lead);
  if (!(length > kMostLead)) return;
  const math::Vec3 p_world = seen.X_world_tool.translation + (kLeadKept / length) * lead;
  const TrocarJoints& joints = input_.hands[chosen];
  device_.Place(chosen, SampleOf(instrument::FindJoints(GetScene().instruments[chosen].p_world_port, p_world,
                                                        joints.spin, joints.jaw)));
}

void SessionControl::SetPaused(bool is_paused) {
  if (is_paused) device_.ReleaseAll();
  session_->SetPaused(is_paused);
  TakeStanding();
}

void SessionControl::Reset() {
  session_->Reset();
  PlaceAtHome();
}

void SessionControl::SetDemonstration(bool is_on) {
  is_on = is_on && HasScript();
  if (is_on == is_demonstration_) return;
  is_demonstration_ = is_on;
  device_.ReleaseAll();
  ReleasePedals();
  if (!is_on) return session_->EndDemonstration();
  session_->BeginDemonstration();
  PlaceAtHome();
}

void SessionControl::ChooseTool(instrument::Hand hand, std::size_t place) {
  session_->Input().ChooseTool(hand, place);
  TakeStanding();
}

void SessionControl::StepTool(int step) {
  session_->Input().StepTool(static_cast<instrument::Hand>(hand_), step);
  TakeStanding();
}

void SessionControl::SetPedal(Pedal pedal, bool is_down) {
  const auto hand = static_cast<instrument::Hand>(hand_);
  is_down = is_down && MayAct();
  switch (pedal) {
    case Pedal::kCut:
      session_->Input().SetPedal(hand, session::Pedal::kCut, is_down);
      break;
    case Pedal::kCoagulate:
      session_->Input().SetPedal(hand, session::Pedal::kCoagulate, is_down);
      break;
    case Pedal::kRinse:
      session_->Input().SetPedal(hand, session::Pedal::kRinse, is_down);
      break;
    case Pedal::kAspirate:
      session_->Input().SetPedal(hand, session::Pedal::kAspirate, is_down);
      break;
    case Pedal::kClutch:
      session_->Input().SetClutch(hand, is_down);
      break;
  }
  TakeStanding();
}

void SessionControl::ToggleFreeze() {
  if (MayAct()) session_->Input().ToggleFreeze(static_cast<instrument::Hand>(hand_));
}

void SessionControl::ReleasePedals() {
  session_->Input().ReleasePedals();
  TakeStanding();
}

void SessionControl::CommandAssistant(scene::AssistantCommand command) {
  session_->Input().CommandAssistant(command);
  TakeStanding();
}

void SessionControl::StepAssistant() {
  CommandAssistant(session::NextCommand(session_->Input().Standing().assistant));
}

void SessionControl::SetCameraHolder(bool is_on) {
  scene::LiveSettings settings = input_.settings;
  settings.holds_camera = is_on;
  SetSettings(settings);
}

void SessionControl::ChooseHand(Channel hand) {
  if (hand == device::kLaparoscope) return;
  if (hand != hand_) ReleasePedals();
  hand_ = hand;
  if (has_camera_ || !IsLaparoscopeHeld()) device_.Choose(hand);
  has_camera_ = false;
}

void SessionControl::SwitchHand() {
  ChooseHand(hand_ == device::kLeftHand ? device::kRightHand : device::kLeftHand);
}

void SessionControl::HoldLaparoscope(bool is_held) {
  if (is_held) SetCameraHolder(false);
  has_camera_ = has_camera_ || (is_held && is_camera_task_);
  device_.Choose(is_held || has_camera_ ? device::kLaparoscope : hand_);
}

void SessionControl::Scroll(double steps) {
  const bool goes_in = steps > 0 && has_depth_snap_ && !is_fulcrum_mirrored_ && !IsLaparoscopeHeld();
  if (!goes_in) return device_.Scroll(steps);
  const simulation::Snapshot& now = Now();
  // where the hand is, not the tool, which follows it
  const math::Vec3 tip =
      instrument::CalcToolPose(GetScene().instruments[hand_].p_world_port, input_.hands[hand_]).translation;
  const math::Pose X_world_view = CalcView(now);
  const math::Vec3 away = math::Rotate(X_world_view.rotation, CalcSightLine(X_world_view, tip));
  const auto ahead = FindDistanceAhead(GetScene(), Surfaces(), Strands(), now, tip, away);
  const double step = device::MouseKeyboardSettings().metres_per_step;
  const double left = ahead ? *ahead - kSnapGap - wheel_under_way_ : 2 * steps * step;
  // at it already: the person wants to go on, once what was turned has been walked
  const bool is_at_it = ahead && *ahead < 2 * kSnapGap;
  const double given = is_at_it ? steps : std::clamp(left / step, 0.0, steps);
  wheel_under_way_ += given * step;
  device_.Scroll(given);
}

void SessionControl::SetMirrorFulcrum(bool is_mirrored) {
  is_fulcrum_mirrored_ = is_mirrored;
  device_.SetMirrorFulcrum(is_mirrored);
}

void SessionControl::SetPicture(double field_of_view, double pixels) {
  field_of_view_ = field_of_view;
  pixels_ = pixels;
}

void SessionControl::SetSettings(const scene::LiveSettings& settings) {
  session_->Input().SetSettings(settings);
  TakeStanding();
}

}  // namespace trocar::presenter
