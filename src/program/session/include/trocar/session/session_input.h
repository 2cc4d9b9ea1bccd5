// SPDX-License-Identifier: Apache-2.0
/// \file session_input.h  The one place where hands are put together: mouse, keys and panel, a device, haptics, a demonstration.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "trocar/host/priority_mutex.h"
#include "trocar/scene/scene.h"
#include "trocar/session/hand_device.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/simulation/input_source.h"

namespace trocar::session {

/// Pedal of a hand, as long as a foot or a key holds it down.
enum class Pedal : std::uint8_t { kCut, kCoagulate, kRinse, kAspirate };
inline constexpr std::size_t kPedalCount = 4;

/// A program that moves hands in a person's place.
struct Guide {
  std::shared_ptr<simulation::InputSource> source;  ///< null: nobody
  /// A script: it moves the two hands; laparoscope, tools, pedals and assistant stay the person's. Else only the settings do.
  bool is_hands_only = false;
  /// Devices keep the hands that they hold, and their buttons. Else nothing of theirs counts: it is a demonstration.
  bool yields_to_devices = false;
};

/// Input of a session, of everybody who takes part.
///
/// Requests of a person (mouse, keys, panel) come from another thread, by the members that return a tick: they take effect in
/// that tick, which is the next one whose input has not been put together, and hold until another request. A pedal that is
/// pressed and let go between two ticks is down in one. Devices are looked at in each tick.
///
/// A later one of these takes the place of an earlier one, hand by hand: the person's request, a guide that yields, a device, a
/// haptic device, a demonstration. Hands and tools stay where whoever held them last has left them.
class SessionInput final : public simulation::InputSource {
 public:
  /// Hands at home, no pedal, settings of the scene.
  ///
  /// \param scene          outlives this
  /// \param next_tick      the first that is going to be made
  /// \param rounds_joints  as record::RoundJoints; false: inputs stay as they come, for runs that are compared bit by bit
  explicit SessionInput(const scene::Scene& scene, std::uint64_t next_tick = 1, bool rounds_joints = true);

  // requests of the person

  std::uint64_t MoveHand(device::Channel channel, const instrument::TrocarJoints& joints);
  /// A place that the tray does not have is ignored.
  std::uint64_t ChooseTool(instrument::Hand hand, std::size_t place);
  /// \param step  places round the tray, also negative
  std::uint64_t StepTool(instrument::Hand hand, int step);
  std::uint64_t SetPedal(instrument::Hand hand, Pedal pedal, bool is_down);
  /// Clutch of a device's hand by a key or a foot pedal.
  std::uint64_t SetClutch(instrument::Hand hand, bool is_held);
  /// The device's hand stands still until the next call.
  std::uint64_t ToggleFreeze(instrument::Hand hand);
  /// All pedals and clutches, also those that were pressed since the last tick.
  std::uint64_t ReleasePedals();
  std::uint64_t CommandAssistant(scene::AssistantCommand command);
  /// \param settings  clamped to their ranges
  std::uint64_t SetSettings(const scene::LiveSettings& settings);
  /// The middle of an attempt: everything is as that input says, whose settings are within their ranges.
  std::uint64_t GoOnFrom(const scene::Input& input);
  /// The simulation is about to go back to its first tick: from that on hands are at home, pedals up and settings as they are.
  /// A tick that is still made before Reset() keeps the input of the one before it.
  /// \return the first tick
  std::uint64_t BeginAnew();

  // who else takes part

  /// \param device  takes the place of one that was dropped before
  void UseDevice(std::unique_ptr<HandDevice> device);
  /// Returns once the device has ended.
  void DropDevice();
  /// \param link  outlives this
  void UseHaptics(HapticLink& link);
  /// From the next tick on. Whoever takes over finds hands and tools as the tick under way leaves them.
  void SetGuide(Guide guide);
  /// The guide has come to its end.
  bool IsGuideOver() const { return is_guide_over_.load(); }
  /// Called in the tick in which a device is lost, by the simulation's thread, which may be told to pause.
  void OnDeviceLoss(std::function<void()> on_loss);

  // what stands

  /// Requests and hands as they stand: the next tick begins with them. Device pedals are not in it.
  scene::Input Standing() const;
  /// Input of the newest tick; while paused, what a tick would get.
  scene::Input Last() const;
  /// In the newest tick a device or a haptic device held that hand.
  bool IsHeldByDevice(instrument::Hand hand) const;
  /// Newest message of the device about itself, given once; empty where there is nothing new.
  std::string TakeDeviceMessage();
  /// Times that a device was lost.
  std::uint64_t DeviceLosses() const { return losses_.load(); }

  // of the simulation's thread

  scene::Input For(std::uint64_t tick, const simulation::Snapshot& before) override;
  void AfterTick(const simulation::Snapshot& after) override;
  void Wait(const simulation::Snapshot& now) override;
  void Reset() override;
  bool IsDemonstration() const override { return is_demonstration_; }

 private:
  using Presses = std::array<std::array<bool, kPedalCount>, instrument::kHandCount>;
  /// Guide's input of a tick; nothing without one.
  struct Guidance {
    Guide guide;
    scene::Input input;
  };
  scene::Input Home() const;
  void GoHome();
  void LiftPedals();
  void LookAtDevices(double time, bool may_act, bool may_move);
  void Follow(const simulation::Snapshot& snapshot, bool is_demonstrated, bool is_hands_only);
  void Combine(double time, const Guidance& guidance);
  std::uint64_t CountPlaces(instrument::Hand hand) const { return scene_->instruments[hand].tray.size(); }

  const scene::Scene* scene_;
  bool rounds_joints_;
  bool is_demonstration_ = false,
       is_hands_only_ = false;  // the guide of the last tick; of the simulation's thread
  std::atomic<bool> is_guide_over_{false};
  std::atomic<std::uint64_t> losses_{0};

  mutable host::PriorityMutex mutex_;  // of all that follows
  std::uint64_t next_tick_;
  int resets_due_ = 0;  // that were asked for and have not come
  scene::Input standing_, last_;
  Presses presses_{};  // since the last tick
  std::unique_ptr<HandDevice> device_;
  DeviceHands device_hands_, stylus_hands_;
  DeviceActs device_acts_, stylus_acts_;
  HapticLink* haptics_ = nullptr;
  HapticHandsReader haptic_hands_;
  std::array<bool, instrument::kHandCount> is_held_by_device_{};
  std::uint64_t device_losses_ = 0;  // of the present device
  std::string device_message_;
  bool is_device_message_new_ = false;
  std::function<void()> on_loss_;
  Guide guide_;
};

}  // namespace trocar::session
