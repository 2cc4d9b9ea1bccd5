// SPDX-License-Identifier: Apache-2.0
/// \file haptic_loop.h  The 1 kHz thread between haptic devices and the simulation, and what it tells the person.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/device/force_driver.h"
#include "trocar/haptics/check_pose.h"
#include "trocar/haptics/haptic_channel.h"
#include "trocar/host/newest_slot.h"
#include "trocar/scene/scene.h"
#include "trocar/session/device_hands.h"
#include "trocar/session/supervisor_link.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::session {

/// One channel of the device and the hand it stands for.
struct HapticHand {
  instrument::Hand hand = instrument::kRight;
  math::Vec3 p_world_port;          ///< trocar point [m]
  double max_jaw = 1.0;             ///< of the tool [rad]
  haptics::DeviceMap map;           ///< device frame into the patient's
  math::Vec3 p_device_check;        ///< check pose, device frame [m]
  std::uint32_t dead_man_mask = 1;  ///< buttons of which one must be held; 0: the pedal
};

/// Allocations of the calling thread so far; for benchmarks.
using CountAllocations = std::uint64_t (*)() noexcept;

/// Device in front of a seated person who looks at the laparoscope's picture: the device's right, up and towards the
/// person are the picture's, and the middle of the device's workspace is the tool's home.
/// \param X_world_laparoscope  as in a snapshot
/// \param scale                newtons in the hand for a newton at the tool [-], > 0
HapticHand MakeHapticHand(const scene::Scene& scene, const math::Pose& X_world_laparoscope,
                          instrument::Hand hand, double scale = 1.0);

/// State of the hands, from the haptic loop to the simulation.
struct HapticHands {
  std::array<bool, instrument::kHandCount> is_driven{};
  std::array<instrument::TrocarJoints, instrument::kHandCount> joints;
  DeviceActs
      acts;  ///< of the styluses' buttons behind safety switch and jaws; up where a device is lost or silent
};

/// One hand's force feedback, for the person and the record.
struct HapticHandStatus {
  bool is_present = false;  ///< a channel stands for this hand
  haptics::ArmState state = haptics::ArmState::kUnarmed;
  haptics::Fault reason = haptics::Fault::kNotRequested;  ///< why not armed
  std::uint8_t limits = 0;                                ///< haptics::GateLimit
  double force = 0;                                       ///< in the hand [N]
  double heat = 0;                                        ///< of the motors, 1 is what they bear for ever [-]
  bool is_warm = false;           ///< the device says so, or the force is held back for heat
  bool is_switch_held = false;    ///< the safety switch
  std::uint64_t armed_ticks = 0;  ///< with force, ramping included, since the start
  std::uint64_t clamped_ticks =
      0;                 ///< in which the force would have been larger than the device's, since the start
  double max_force = 0;  ///< since the start [N]
  haptics::DeviceGuardCounts counts;
  device::HandActs acts;  ///< of the stylus
};

/// Of the whole loop; times over the last second.
struct HapticStatus {
  std::uint64_t ticks = 0;
  std::uint64_t late_ticks = 0;                            ///< more than half a period late
  std::uint64_t overruns = 0;                              ///< so late that the force had to go
  double rate = 0;                                         ///< [1/s]
  double period_p50 = 0, period_p999 = 0, period_max = 0;  ///< [s]
  double cpu_p999 = 0, cpu_max = 0;                        ///< processor time of a tick [s]
  bool is_real_time = false;                               ///< SCHED_FIFO was granted
  bool is_supervised = false;
  haptics::CheckPoseState check_pose = haptics::CheckPoseState::kUnconfirmed;
  instrument::Hand asked = instrument::kLeft;  ///< whose device the check pose waits for
  std::array<HapticHandStatus, instrument::kHandCount> hands;
};
/// One line for a person, for example "Force 1000 Hz: left armed 0.8 N, right off: nobody holds the safety switch (hold
/// the button or pedal and switch force on again)".
std::string DescribeHaptics(const HapticStatus& status);
/// The status as one JSON object for a record: times in microseconds (_us), forces in newtons, states and reasons by name.
std::string FormatHapticsJson(const HapticStatus& status);

/// Mailboxes between the simulation's thread and the loop's; neither waits for the other.
struct HapticLink {
  std::atomic<bool> is_used{false};  ///< a loop runs: the simulation cuts patches only then
  std::array<host::NewestSlot<tissue::LocalPatch>, instrument::kHandCount> patches;  ///< simulation to loop
  host::NewestSlot<HapticHands> hands;                                               ///< loop to simulation
};

/// The simulation's end of the link.
class HapticHandsReader {
 public:
  /// Ticks without news from the loop after which it holds no pedal any more: a loop that stands still burns nothing.
  static constexpr int kLongestSilence = 12;

  /// Hands and acts of the haptic devices; call it once a tick.
  /// \return nullptr while no loop runs; else valid until the next call
  /// \note Real-time safe.
  const HapticHands* Take(HapticLink& link) noexcept;

 private:
  HapticHands hands_;
  int silent_ticks_ = 0;
};

struct HapticLoopSettings {
  std::vector<HapticHand> hands;     ///< one a channel of the driver
  std::filesystem::path supervisor;  ///< program trocar-supervisor; empty: none, and no force
  double period = 0.001;             ///< [s]
  device::ButtonMap buttons = device::DefaultButtons();
  CountAllocations count_allocations = nullptr;  ///< counts what the ticks allocate, for benchmarks
  double spin = 0.00025;  ///< waited for actively before each tick, because sleep wakes late [s]
};

/// Settings that let a device's channels be the right hand, or both.
/// \param X_world_laparoscope  as in a snapshot
/// \param buttons              of the styluses, behind safety switch and jaws
/// \return kDeviceSettings where the device has more channels than a person has hands
base::Result<HapticLoopSettings> MakeHapticSettings(const device::ForceDriver& driver,
                                                    const scene::Scene& scene,
                                                    const math::Pose& X_world_laparoscope,
                                                    const device::ButtonMap& buttons);

/// Owns the driver and the thread.
class HapticLoop {
 public:
  /// Configures and activates the driver, starts the supervisor and the thread. Unarmed.
  ///
  /// \param driver  unconfigured
  /// \param link    shared with the simulation's Runner; must outlive this
  /// \return the driver's error, kDeviceSettings (hands and channels differ) or kHapticSupervisor
  static base::Result<std::unique_ptr<HapticLoop>> Start(std::unique_ptr<device::ForceDriver> driver,
                                                         const HapticLoopSettings& settings,
                                                         HapticLink& link);
  /// Zero force, then ends.
  ~HapticLoop();
  HapticLoop(const HapticLoop&) = delete;
  HapticLoop& operator=(const HapticLoop&) = delete;

  /// A person asks for force in every hand.
  void RequestArm() noexcept;
  /// A person wants no force.
  void Stop() noexcept;
  /// Asks for the check poses, hand by hand.
  void BeginCheckPose() noexcept;
  /// A safety switch that is not on the device.
  void SetPedal(bool is_held) noexcept;

  /// The newest status, at most a twentieth of a second old; one caller.
  const HapticStatus& Latest() noexcept;
  /// Percentile over the whole run [s]; for benchmarks. \param fraction  [-] in [0, 1]
  double CalcPeriodPercentile(double fraction) const noexcept;
  double CalcCpuPercentile(double fraction) const noexcept;
  /// Of all ticks since ClearTimes(); 0 without a counter.
  std::uint64_t CountAllocated() const noexcept;
  /// The percentiles and counts over the whole run begin anew.
  void ClearTimes() noexcept;

 private:
  struct Content;
  explicit HapticLoop(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::session
