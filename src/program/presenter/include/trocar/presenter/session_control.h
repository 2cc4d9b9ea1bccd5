// SPDX-License-Identifier: Apache-2.0
/// \file session_control.h  Mouse, keys and panel of the window's user, turned into requests to the session. No widget.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "trocar/device/mouse_keyboard.h"
#include "trocar/session/session.h"

namespace trocar::presenter {

/// Pedal under the foot, or a key in its place.
enum class Pedal { kCut, kCoagulate, kRinse, kAspirate, kClutch };

/// Whether all that a task asks for is done with the laparoscope.
bool IsCameraTask(const scene::Scene& scene);

/// Owns a session, and the mouse and keyboard that hold its instruments. What is asked for takes effect in the session's next
/// tick. Called from one thread.
class SessionControl {
 public:
  /// Starts paused, with the hands at home.
  /// \return kDeviceSettings where the scene's tools cannot be held, or as session::Session::Open
  static base::Result<std::unique_ptr<SessionControl>> Make(simulation::Simulation simulation,
                                                            const session::SessionOptions& options = {});

  /// For a simulation that stands in the middle of an attempt: the hands rest where the tools stand, tools and settings are
  /// as they were, no pedal is pressed.
  /// \param last  input of the tick before
  void GoOnFrom(const scene::Input& last);
  /// The scripted expert goes on from here, where SetDemonstration() would begin anew.
  void LetExpertGoOn();

  /// Lets a device hold the hands that it sees; the mouse keeps the others. Where the device is lost the simulation is
  /// paused, and stays so when it comes back until the person starts it.
  /// \param driver   of device::kChannelCount channels, unconfigured
  /// \param buttons  what its buttons do
  void UseDevice(std::unique_ptr<device::Driver> driver,
                 const device::ButtonMap& buttons = device::DefaultButtons()) {
    session_->UseDevice(std::move(driver), buttons);
  }
  /// Newest message of the device about itself, given once; empty where there is nothing new.
  std::string TakeDeviceMessage() { return session_->Input().TakeDeviceMessage(); }

  /// As session::Session::UseHaptics. What Advance() and Now() gave before is gone.
  base::Status UseHaptics(std::string_view name,
                          const device::ButtonMap& buttons = device::DefaultButtons()) {
    now_ = nullptr;
    return session_->UseHaptics(name, buttons);
  }
  /// The haptic loop, or nullptr without one.
  session::HapticLoop* Haptics() { return session_->Haptics(); }
  /// Record of the haptic loop so far, as Advance() saw it.
  const session::HapticRecord& GetHapticRecord() const { return session_->GetHapticRecord(); }
  /// Port that viewers over OpenIGTLink may connect to, or -1.
  int ServedPort() const { return session_->ServedPort(); }

  /// Moves the hands of mouse and keys on by `dt` [s]; while paused they stand still. A hand that somebody else has moved, they
  /// take up where it is.
  /// \return the newest state, valid until the next call
  const simulation::Snapshot& Advance(double dt);

  void SetPaused(bool is_paused);
  bool IsPaused() const { return session_->IsPaused(); }
  /// The newest state, as the last Advance() saw it.
  const simulation::Snapshot& Now() { return now_ != nullptr ? *now_ : Look(); }
  /// At kSlowMotion of the clock: for practice, see Runner::SetSpeed.
  void SetSlowMotion(bool is_slow) { session_->SetSpeed(is_slow ? kSlowMotion : 1.0); }
  bool IsSlowMotion() const { return session_->GetSpeed() < 1.0; }
  static constexpr double kSlowMotion = 0.35;
  /// Back to the first tick, hands at home; keeps running or paused, and the settings.
  void Reset();
  /// The attempt is over: what is recorded ends here, and nothing more is until the next reset.
  void EndAttempt() { session_->EndAttempt(); }
  /// true: from the first tick on the script, or else a scripted expert, moves both hands. false: the person takes over
  /// where they are.
  void SetDemonstration(bool is_on);
  bool IsDemonstration() const { return is_demonstration_; }
  /// True if the script has come to its end.
  bool IsDemonstrationOver() const { return is_demonstration_ && session_->IsDemonstrationOver(); }
  bool HasScript() const { return session_->CanDemonstrate(); }

  /// Hand that the mouse and keys move while the laparoscope is not held.
  void ChooseHand(device::Channel hand);
  void SwitchHand();
  device::Channel GetHand() const { return hand_; }
  /// While held, the pointer and the keys move the laparoscope. In a camera task they do from the start, and from the next hold
  /// on, until a hand is chosen.
  void HoldLaparoscope(bool is_held);
  bool IsCameraTask() const { return is_camera_task_; }
  /// The automatic holder keeps both tips in the picture; taking the laparoscope ends it, where it is.
  void SetCameraHolder(bool is_on);
  bool HasCameraHolder() const { return input_.settings.holds_camera; }
  bool IsLaparoscopeHeld() const { return device_.GetChosen() == device::kLaparoscope; }
  /// Asks for a tool of a hand's tray; a place that the tray does not have is ignored.
  void ChooseTool(instrument::Hand hand, std::size_t place);
  /// The next tool of the chosen hand, or with -1 the one before, round the tray.
  void StepTool(int step);
  /// Of the chosen hand. Only one hand has pedals at a time: choosing the other releases them. Pedals of devices are apart.
  void SetPedal(Pedal pedal, bool is_down);
  void ReleasePedals();
  /// The chosen hand's tool stands still although its device moves, until it is called again.
  void ToggleFreeze();
  void CommandAssistant(scene::AssistantCommand command);
  /// Retract, relax, release, wait, and again.
  void StepAssistant();

  /// Turns of the wheel. With the snap one that would take the tip into something ends before it; the next goes on.
  void Scroll(double steps);
  void SetDepthSnap(bool is_on) { has_depth_snap_ = is_on; }

  void SetMirrorFulcrum(bool is_mirrored);
  bool IsFulcrumMirrored() const { return is_fulcrum_mirrored_; }

  /// Size of the drawn picture, so that the tip keeps up with the pointer.
  /// \param field_of_view  over `pixels` [rad]
  void SetPicture(double field_of_view, double pixels);

  /// Settings of the next ticks; clamped to their ranges.
  const scene::LiveSettings& GetSettings() const { return input_.settings; }
  void SetSettings(const scene::LiveSettings& settings);
  /// Restores the settings of the scene.
  void RestoreSettings() { SetSettings(GetScene().settings); }

  device::MouseKeyboard& Device() { return device_; }
  const scene::Scene& GetScene() const { return session_->GetScene(); }
  std::span<const scene::SurfaceInfo> Surfaces() const { return session_->Surfaces(); }
  std::span<const scene::StrandInfo> Strands() const { return session_->Strands(); }
  /// Of the attempt that runs or ran last; nothing where none is kept.
  std::optional<record::RecorderStatus> Recording() const { return session_->Recording(); }
  session::RunnerStatistics Statistics() const { return session_->Statistics(); }
  /// The camera of the picture: the laparoscope's, with a level horizon where the scope is straight.
  math::Pose CalcView(const simulation::Snapshot& snapshot) const;
  /// Input that the person asks for by mouse, keys and panel, with hands and tools as devices hold them; as it stood at the last
  /// Advance() or request.
  const scene::Input& GetInput() const { return input_; }
  /// Input of the newest tick, whoever gave it: pedals of devices and of a demonstration are in it, too.
  scene::Input LastInput() const { return session_->Input().Last(); }
  session::Session& GetSession() { return *session_; }

 private:
  SessionControl(std::unique_ptr<session::Session> session, const device::MouseKeyboardSettings& settings);
  /// The newest state; what Look() gave before is gone.
  const simulation::Snapshot& Look() { return *(now_ = &session_->Latest()); }
  void PlaceAtHome();
  void TakeStanding() { input_ = session_->Input().Standing(); }
  void SendHand(device::Channel channel);
  void AdvanceMouse(const simulation::Snapshot& snapshot, double dt);
  void LimitLead(const simulation::Snapshot& snapshot);
  bool MayAct() const { return !IsPaused() && !is_demonstration_; }

  std::unique_ptr<session::Session> session_;
  device::MouseKeyboard device_;
  std::uint64_t device_losses_ = 0;
  const simulation::Snapshot* now_ = nullptr;
  scene::Input input_;  // as it stands in the session
  device::Channel hand_ = device::kRightHand;
  bool is_demonstration_ = false;
  bool is_camera_task_ = false, has_camera_ = false;  // the mouse has the laparoscope without holding a key
  bool is_fulcrum_mirrored_ = false, has_depth_snap_ = false;
  double wheel_under_way_ = 0;  // turned and not walked yet [m]
  double field_of_view_ = 1.0;  // [rad]
  double pixels_ = 700;
};

}  // namespace trocar::presenter
