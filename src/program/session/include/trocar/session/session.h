// SPDX-License-Identifier: Apache-2.0
/// \file session.h  A running simulation with everybody who takes part: hands, devices, force feedback, viewers, recording. No window.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trocar/device/device_store.h"
#include "trocar/host/clock.h"
#include "trocar/net/igtl_server.h"
#include "trocar/session/device_thread.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/session/haptic_record.h"
#include "trocar/session/runner.h"
#include "trocar/session/session_input.h"

namespace trocar::session {

class ViewerFeed;

struct SessionOptions {
  std::optional<AttemptKeeping> keeping;           ///< nothing, or where each attempt is recorded
  std::string device;                              ///< as device::MakeDriver reads it; empty: none
  std::string haptics;                             ///< as device::MakeForceDriver reads it; empty: none
  device::DeviceStore store;                       ///< calibrations and buttons of those
  std::optional<net::IgtlServerSettings> viewers;  ///< nothing: nobody looks on
};

/// Owns the simulation and its thread, the devices with theirs, and the viewers' server. All members are called from one other
/// thread: a window's, a network's or a test's.
class Session {
 public:
  /// Starts paused, with the hands at home.
  /// \return the error of a device, kDeviceSettings, kHapticSupervisor, or kDeviceBusy where the viewers' port is taken
  static base::Result<std::unique_ptr<Session>> Open(simulation::Simulation simulation,
                                                     const SessionOptions& options = {});
  /// No force, then the end of all threads; the recording is whole.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Requests of the person at mouse, keys and panel.
  SessionInput& Input() { return input_; }
  const SessionInput& Input() const { return input_; }

  // time

  /// A pause lifts every pedal.
  void SetPaused(bool is_paused);
  bool IsPaused() const { return runner_->IsPaused(); }
  void SetSpeed(double speed) { runner_->SetSpeed(speed); }
  double GetSpeed() const { return runner_->GetSpeed(); }
  /// Back to the first tick, hands at home; keeps running or paused, and the settings.
  void Reset();
  /// What is recorded ends here, and nothing more is until the next reset.
  void EndAttempt() { runner_->EndAttempt(); }

  // demonstration

  /// Whether the scene has a script, or there is an expert for it.
  bool CanDemonstrate() const;
  /// Back to the first tick, from which on the script, or else the expert, moves the hands.
  void BeginDemonstration();
  /// The same from the next tick on.
  void Demonstrate();
  /// Whoever takes over finds hands and tools where they are.
  void EndDemonstration() { input_.SetGuide({}); }
  bool IsDemonstrationOver() const { return input_.IsGuideOver(); }

  // who else takes part

  /// Lets a device hold the hands that it sees, in place of one before. Where it is lost the simulation is paused.
  /// \param driver   of device::kChannelCount channels, unconfigured
  /// \param buttons  what its buttons do
  void UseDevice(std::unique_ptr<device::Driver> driver,
                 const device::ButtonMap& buttons = device::DefaultButtons());
  /// Lets a haptic device hold the hands that it has channels for (the right one, or both), with force.
  /// \param name     as device::MakeForceDriver reads it
  /// \param buttons  of the styluses, behind safety switch and jaws
  /// \return kDeviceSettings, the driver's error or kHapticSupervisor
  base::Status UseHaptics(std::string_view name, const device::ButtonMap& buttons = device::DefaultButtons());
  /// The haptic loop, or nullptr without one.
  HapticLoop* Haptics() { return haptic_loop_.get(); }
  /// Record of the haptic loop, as Latest() saw it.
  const HapticRecord& GetHapticRecord() const { return haptic_record_; }
  /// Shows every tick to viewers over OpenIGTLink from now on.
  /// \return kDeviceBusy where the port is taken
  /// \pre nobody is served yet
  base::Status Serve(const net::IgtlServerSettings& settings);
  /// Port that viewers may connect to, or -1.
  int ServedPort() const;

  // what is

  /// The newest state, valid until the next call. Also takes down what the haptic loop has done since the last call.
  const simulation::Snapshot& Latest();
  RunnerStatistics Statistics() const { return runner_->Statistics(); }
  /// Of the attempt that runs or ran last; nothing before the first one, or where none are kept.
  std::optional<record::RecorderStatus> Recording() const { return runner_->RecordingStatus(); }
  const scene::Scene& GetScene() const { return runner_->GetScene(); }
  std::span<const scene::SurfaceInfo> Surfaces() const { return runner_->Surfaces(); }
  std::span<const scene::StrandInfo> Strands() const { return runner_->Strands(); }

 private:
  Session(simulation::Simulation simulation, std::optional<AttemptKeeping> keeping);
  Guide MakeGuide() const;

  HapticLink haptic_link_;  // outlives both ends
  SessionInput input_;
  std::unique_ptr<ViewerFeed> viewers_;  // null: nobody looks on
  std::atomic<ViewerFeed*> feed_{nullptr};
  std::unique_ptr<Runner> runner_;
  std::unique_ptr<HapticLoop> haptic_loop_;  // null: none
  HapticRecord haptic_record_;
  host::Stopwatch since_start_;
};

}  // namespace trocar::session
