// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/session_control.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "trocar/device/force_device_spec.h"
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

base::Result<std::unique_ptr<SessionControl>> SessionControl::Make(
    simulation::Simulation simulation, std::optional<session::AttemptKeeping> keeping) {
  const device::MouseKeyboardSettings settings = DeviceSettings(simulation.GetScene());
  std::unique_ptr<SessionControl> control(
      new SessionControl(std::move(simulation), settings, std::move(keeping)));
  if (const base::Status status = control->device_.Configure(); !status) return status.error();
  if (const base::Status status = control->device_.Activate(); !status) return status.error();
  control->PlaceAtHome();
  control->RestoreSettings();
  return control;
}

SessionControl::SessionControl(simulation::Simulation simulation,
                               const device::MouseKeyboardSettings& settings,
                               std::optional<session::AttemptKeeping> keeping)
    : runner_(std::move(simulation), &haptic_link_, std::move(keeping)),
      device_hands_(runner_.GetScene()),
      stylus_hands_(runner_.GetScene()),
      device_(settings) {}

void SessionControl::PlaceAtHome() {
  const scene::Scene& scene = runner_.GetScene();
  device_.ReleaseAll();
  device_.Place(device::kLeftHand, SampleOf(scene.instruments[instrument::kLeft].home));
  device_.Place(device::kRightHand, SampleOf(scene.instruments[instrument::kRight].home));
  device_.Place(device::kLaparoscope, SampleOf(scene.laparoscope.home));
}

void SessionControl::GoOnFrom(const scene::Input& last) {
  const simulation::Snapshot& snapshot = Look();
  device_.ReleaseAll();
  for (const Channel hand : {device::kLeftHand, device::kRightHand})
    device_.Place(hand, SampleOf(snapshot.instruments[hand].joints));
  device_.Place(device::kLaparoscope, SampleOf(snapshot.laparoscope));
  input_ = last;
  ReleasePedals();
}

void SessionControl::LetExpertGoOn() {
  if (!HasScript() || is_demonstration_) return;
  is_demonstration_ = true;
  device_.ReleaseAll();
  ReleasePedals();
  runner_.SetScripted(true);
}

const simulation::Snapshot& SessionControl::Advance(double dt) {
  const simulation::Snapshot& snapshot = Look();
  time_ = snapshot.time;
  if (haptic_loop_ != nullptr) haptic_record_.Add(since_start_.Seconds(), haptic_loop_->Latest());
  if (server_ != nullptr && snapshot.tick != served_tick_) {
    served_tick_ = snapshot.tick;
    server_->Publish(snapshot);
  }
  if (is_demonstration_) {
    // the person's hands rest on the script's, so that taking over makes no jump
    for (const Channel hand : {device::kLeftHand, device::kRightHand})
      device_.Place(hand, SampleOf(snapshot.instruments[hand].joints));
    for (std::size_t hand = 0; hand < input_.controls.size(); ++hand)
      input_.controls[hand].tool = snapshot.operation.tools[hand];
  }

  // as with the hands: whoever takes the laparoscope over takes it where it is
  const bool is_experts = is_demonstration_ && runner_.GetScene().script.keys.empty();
  if (HasCameraHolder() || is_experts) device_.Place(device::kLaparoscope, SampleOf(snapshot.laparoscope));

  std::array<HandSample, device::kChannelCount> samples;
  if (!runner_.IsPaused()) {
    LimitLead(snapshot);
    const math::Pose X_world_view = CalcView(snapshot);
    device_.Read(samples);
    for (const Channel channel : {device::kLeftHand, device::kRightHand, device::kLaparoscope})
      device_.SetPointerMap(channel, CalcPointerMap(JointsOf(samples[channel]), X_world_view));
    const Channel chosen = device_.GetChosen();
    const math::Vec3 p_world_followed = chosen == device::kLaparoscope
                                            ? X_world_view * math::Vec3{0, 0, -kLookDistance}
                                            : snapshot.instruments[chosen].X_world_tool.translation;
    device_.SetMetresPerPixel(CalcMetresPerPixel(X_world_view, p_world_followed, field_of_view_, pixels_));
    device_.Advance(dt);
    wheel_under_way_ *= std::exp(-dt / device::MouseKeyboardSettings().wheel_time);
  }
  device_.Read(samples);
  for (const Channel hand : {device::kLeftHand, device::kRightHand})
    if (samples[hand].is_valid) input_.hands[hand] = JointsOf(samples[hand]);
  if (samples[device::kLaparoscope].is_valid) input_.laparoscope = JointsOf(samples[device::kLaparoscope]);
  if (haptic_loop_ != nullptr) ApplyStylusButtons();
  sent_ = input_;
  if (device_thread_ != nullptr) ApplyDevice();
  runner_.SetInput(sent_);
  return snapshot;
}

math::Pose SessionControl::CalcView(const simulation::Snapshot& snapshot) const {
  const bool is_straight = std::fabs(runner_.GetScene().laparoscope.view_angle) < kStraight;
  return is_straight ? LevelHorizon(snapshot.X_world_laparoscope) : snapshot.X_world_laparoscope;
}

void SessionControl::LimitLead(const simulation::Snapshot& snapshot) {
  const Channel chosen = device_.GetChosen();
  if (chosen == device::kLaparoscope || is_demonstration_) return;
  const simulation::InstrumentSnapshot& seen = snapshot.instruments[chosen];
  const math::Vec3 lead = seen.X_world_device.translation - seen.X_world_tool.translation;
  const double length = math::Norm(lead);
  if (!(length > kMostLead)) return;
  const math::Vec3 p_world = seen.X_world_tool.translation + (kLeadKept / length) * lead;
  const TrocarJoints& joints = input_.hands[chosen];
  device_.Place(chosen, SampleOf(instrument::FindJoints(runner_.GetScene().instruments[chosen].p_world_port,
                                                        p_world, joints.spin, joints.jaw)));
}

void SessionControl::UseDevice(std::unique_ptr<device::Driver> driver, const device::ButtonMap& buttons) {
  session::PlaceAtHome(runner_.GetScene(), *driver);
  device_thread_.reset();  // one device's line, buttons and messages end before the other's begin
  device_hands_ = session::DeviceHands(runner_.GetScene());
  device_losses_ = 0;
  device_thread_ = std::make_unique<session::DeviceThread>(std::move(driver), buttons);
}

base::Status SessionControl::UseHaptics(std::string_view name, const device::ButtonMap& buttons) {
  auto driver = device::MakeForceDriver(name);
  if (!driver) return driver.error();
  const auto settings =
      session::MakeHapticSettings(**driver, runner_.GetScene(), Look().X_world_laparoscope, buttons);
  if (!settings) return settings.error();
  auto loop = session::HapticLoop::Start(std::move(*driver), *settings, haptic_link_);
  if (!loop) return loop.error();
  haptic_loop_ = std::move(*loop);
  return {};
}

base::Status SessionControl::Serve(int port) {
  net::IgtlServerSettings settings;
  settings.port = port;
  auto server = net::IgtlServer::Make(settings, runner_.Surfaces());
  if (!server) return server.error();
  server_ = std::move(*server);
  return {};
}

void SessionControl::ApplyDevice() {
  const session::DeviceReport& report = device_thread_->Latest();
  if (report.message != device_message_) {
    device_message_ = report.message;
    is_device_message_new_ = true;
  }
  if (report.losses != device_losses_) {
    device_losses_ = report.losses;
    SetPaused(true);
  }
  if (is_demonstration_) return device_hands_.Ignore(report.acts);
  if (MayAct()) {
    device_hands_.Step(report.acts, input_);
  } else {
    device_hands_.Ignore(report.acts);
  }
  device_hands_.Move(report.samples, report.acts, input_);
  sent_ = input_;
  if (MayAct()) session::PressPedals(report.acts, sent_);
  // the mouse's hands rest on the device's, so that losing sight of one makes no jump
  for (const Channel hand : {device::kLeftHand, device::kRightHand}) {
    if (report.samples[hand].is_valid) device_.Place(hand, SampleOf(input_.hands[hand]));
  }
}

/// Pedals of a stylus reach the tick by the loop's own way; what a press changes for good comes in here.
void SessionControl::ApplyStylusButtons() {
  const session::HapticStatus& status = haptic_loop_->Latest();
  const session::DeviceActs acts = {status.hands[instrument::kLeft].acts,
                                    status.hands[instrument::kRight].acts};
  if (MayAct()) {
    stylus_hands_.Step(acts, input_);
  } else {
    stylus_hands_.Ignore(acts);
  }
}

std::string SessionControl::TakeDeviceMessage() {
  return std::exchange(is_device_message_new_, false) ? device_message_ : std::string();
}

void SessionControl::SetPaused(bool is_paused) {
  if (is_paused) {
    device_.ReleaseAll();
    ReleasePedals();
  }
  runner_.SetPaused(is_paused);
}

void SessionControl::Reset() {
  PlaceAtHome();
  input_.controls = {};
  input_.assistant = {};
  device_hands_.Restart();
  time_ = 0.0;
  runner_.Reset();
}

void SessionControl::SetDemonstration(bool is_on) {
  is_on = is_on && HasScript();
  if (is_on == is_demonstration_) return;
  is_demonstration_ = is_on;
  device_.ReleaseAll();
  ReleasePedals();
  if (is_on) Reset();
  runner_.SetScripted(is_on);
}

bool SessionControl::IsDemonstrationOver() const {
  return is_demonstration_ && runner_.IsScriptOver();
}

void SessionControl::ChooseTool(instrument::Hand hand, std::size_t place) {
  if (place < runner_.GetScene().instruments[hand].tray.size())
    input_.controls[hand].tool = static_cast<std::uint8_t>(place);
}

void SessionControl::StepTool(int step) {
  const auto hand = static_cast<instrument::Hand>(hand_);
  const auto count = static_cast<int>(runner_.GetScene().instruments[hand].tray.size());
  if (count > 0)
    ChooseTool(hand, static_cast<std::size_t>((input_.controls[hand].tool + step + count) % count));
}

void SessionControl::SetPedal(Pedal pedal, bool is_down) {
  scene::HandControls& controls = input_.controls[hand_];
  is_down = is_down && !IsPaused() && !is_demonstration_;
  switch (pedal) {
    case Pedal::kCut:
      controls.cut = is_down;
      break;
    case Pedal::kCoagulate:
      controls.coagulate = is_down;
      break;
    case Pedal::kRinse:
      controls.rinse = is_down;
      break;
    case Pedal::kAspirate:
      controls.aspirate = is_down;
      break;
    case Pedal::kClutch:
      device_hands_.SetClutch(static_cast<instrument::Hand>(hand_), is_down);
      break;
  }
}

void SessionControl::ToggleFreeze() {
  if (MayAct()) device_hands_.ToggleFreeze(static_cast<instrument::Hand>(hand_));
}

void SessionControl::ReleasePedals() {
  for (scene::HandControls& controls : input_.controls)
    controls.cut = controls.coagulate = controls.rinse = controls.aspirate = false;
  for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight})
    device_hands_.SetClutch(hand, false);
}

void SessionControl::StepAssistant() {
  input_.assistant = session::NextCommand(input_.assistant);
}

void SessionControl::ChooseHand(Channel hand) {
  if (hand == device::kLaparoscope) return;
  if (hand != hand_) ReleasePedals();
  hand_ = hand;
  if (!IsLaparoscopeHeld()) device_.Choose(hand);
}

void SessionControl::SwitchHand() {
  ChooseHand(hand_ == device::kLeftHand ? device::kRightHand : device::kLeftHand);
}

void SessionControl::HoldLaparoscope(bool is_held) {
  if (is_held) SetCameraHolder(false);
  device_.Choose(is_held ? device::kLaparoscope : hand_);
}

void SessionControl::Scroll(double steps) {
  const bool goes_in = steps > 0 && has_depth_snap_ && !is_fulcrum_mirrored_ && !IsLaparoscopeHeld();
  if (!goes_in) return device_.Scroll(steps);
  const simulation::Snapshot& now = Now();
  const math::Vec3 away = math::Rotate(CalcView(now).rotation, math::Vec3{0, 0, -1});
  // where the hand is, not the tool, which follows it
  const math::Vec3 tip =
      instrument::CalcToolPose(GetScene().instruments[hand_].p_world_port, input_.hands[hand_]).translation;
  const auto ahead = FindDistanceAhead(GetScene(), Surfaces(), now, tip, away);
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
  input_.settings = scene::ClampSettings(settings);
}

}  // namespace trocar::presenter
