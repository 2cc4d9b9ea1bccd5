// SPDX-License-Identifier: Apache-2.0
/// \file force_driver.h  Devices that push back: what they report, what they can bear, and the one kind of force
/// that they accept.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "trocar/device/driver.h"
#include "trocar/math/pose.h"
#include "trocar/math/vector.h"

namespace trocar::haptics {
class ForceGate;  // the only maker of forces that are not zero; see haptics/force_gate.h
}

namespace trocar::device {

/// A force that may be sent. Only haptics::ForceGate makes one that is not zero, so that no path around the gate
/// compiles; a driver stores and sends it as it is and never computes one.
class GatedForce {
 public:
  /// Zero, which anybody may send at any time.
  constexpr GatedForce() noexcept = default;
  /// On the hand, device frame [N].
  const math::Vec3& Get() const noexcept { return force_; }

 private:
  friend class haptics::ForceGate;
  explicit GatedForce(const math::Vec3& force) noexcept : force_(force) {}
  math::Vec3 force_;
};

/// Capabilities and limits of one device, by its maker or by measurement. 0 where not known, except max_force.
struct ForceLimits {
  double max_force = 0;                     ///< nominal maximum [N], > 0
  double max_continuous_force = 0;          ///< that the motors bear for ever [N]
  double max_stiffness = 0;                 ///< stiffest stable wall [N/m]
  double damping = 0;                       ///< of the mechanism, viscous: b [N s/m]
  double friction = 0;                      ///< of the mechanism, Coulomb: f_c [N]
  double mass = 0;                          ///< apparent, at the point that the hand holds [kg]
  double position_step = 0;                 ///< of the encoders at that point: Delta [m]
  math::Vec3 workspace_min, workspace_max;  ///< box in the device frame; equal where it is not known [m]
};

/// Largest nominal force of a hand-held haptic device that is believed [N]: the strongest that are sold bear about 40.
inline constexpr double kLargestForceLimit = 50;
/// Smallest [N]: less is lost in a device's own friction.
inline constexpr double kSmallestForceLimit = 0.1;

/// Whether limits are those of a device that a hand can hold. Gate, coupling and guards are only as good as these numbers.
/// \param name  of the device, for the message
/// \return kDeviceSettings with the number that is wrong, and the remedy
base::Status CheckLimits(const ForceLimits& limits, const std::string& name);

enum class ForceDeviceStatus : std::uint8_t {
  kOk,
  kWarm,  ///< motors warm or another error that passes by itself: this force was not applied in full
  kLost   ///< gone, or an error that does not pass; the driver must be configured again
};

/// Report of one device, unchanged: a driver makes no good pose of a bad one, but leaves that judgement to the guard of the
/// haptic loop. Device frame: x to the person's right, y up, z towards the person; metres.
struct ForceSample {
  math::Vec3 position;  ///< of the point where the force acts [m]
  math::Vec3 velocity;  ///< of that point, measured or derived by the driver [m/s]
  math::Quaternion
      orientation;  ///< of the stylus, X_device_stylus; all zero where what it reports is no rotation
  std::uint32_t buttons = 0;   ///< bit 0 is the first button; bit n is set while it is held
  double jaw = 0;              ///< opening by a gripper [rad]; NaN where the device has none
  double temperature = 0;      ///< of the motors as a share of what they bear, 0 to 1 [-]; NaN where unknown
  std::uint64_t sequence = 0;  ///< grows with every new report of the device; equal = nothing new
  bool is_calibrated = false;  ///< the device says that its encoders are referenced
  ForceDeviceStatus status = ForceDeviceStatus::kLost;
};

/// Buttons of a stylus that have a fixed use, safety switch and jaws; those behind them are the hand's (HandButtons).
inline constexpr unsigned kStylusOwnButtons = 2;

/// A wire that another process can take over when ours dies: the file that the forces go out by, and the bytes
/// that mean zero force on it.
struct SupervisedWire {
  static constexpr std::size_t kMaxBytes = 512;
  int file = -1;         ///< descriptor, stays the driver's; -1: the device is reached through a library
                         ///< of its maker, see SupervisedLibrary
  std::size_t size = 0;  ///< of zero_frame, <= kMaxBytes
  std::array<std::uint8_t, kMaxBytes> zero_frame{};
  bool is_closed_after = false;  ///< sockets: shut down once the frame has been sent
};

/// Processes that hold devices through a library of their maker, for another process that ends the force when they, or ours,
/// cannot any more.
struct SupervisedLibrary {
  std::string request;  ///< how the devices are opened
  std::vector<int>
      files;  ///< page and pidfd of the process that holds them, and of its spare where there is one; they stay the driver's
};

/// A device with force output. One thread, the haptic loop, calls everything but the life cycle; the life cycle is
/// called while that thread leaves the driver alone.
///
/// Duties of a device family beside the private functions:
/// - nothing is sent before DoActivate; DoActivate, DoDeactivate and a lost device send zero, as far as they can;
/// - a force lives kForceLife: without a newer SendForce the driver's own thread, if it has one, sends zero;
/// - Read() gives HandSamples as any driver does; ReadForceSamples() the raw reports for the loop.
class ForceDriver : public Driver {
 public:
  /// Longest time that a force acts without being renewed [s].
  static constexpr double kForceLife = 0.010;

  /// \param channel  0 to GetChannelCount() - 1
  /// \return the limits read from the device or known for its model; meaningful from Inactive on
  virtual ForceLimits GetLimits(int channel) const noexcept = 0;

  /// The newest report of every channel.
  ///
  /// \param[out] samples  (GetChannelCount())
  /// \return as Read(); after kLost every sample says kLost, zero has been sent as far as that is possible, and the driver
  ///         is unconfigured; Release() closes it, and is not called here, because a library may take its time
  /// \pre samples has exactly that size (TROCAR_ASSERT)
  /// \note Real-time safe: no allocation, lock, wait or throw.
  ReadStatus ReadForceSamples(std::span<ForceSample> samples) noexcept;

  /// Sends a force, or leaves it to the driver's own thread to send at once. Does nothing unless active.
  /// \note Real-time safe: no allocation, lock, wait or throw; a full wire drops the older force, not this one.
  void SendForce(int channel, const GatedForce& force) noexcept;

  /// For the supervisor process; the descriptor is duplicated by whoever asks.
  virtual SupervisedWire GetSupervisedWire(int channel) const noexcept;
  /// Of all channels together. A device that moves a hand has this or a wire.
  virtual SupervisedLibrary GetSupervisedLibrary() const;

 protected:
  using Driver::Driver;

 private:
  /// Refuses implausible limits of any channel, whatever the family.
  base::Status CheckConfigured() const final;
  virtual ReadStatus DoReadForceSamples(std::span<ForceSample> samples) noexcept = 0;
  virtual void DoSendForce(int channel, const GatedForce& force) noexcept = 0;
};

}  // namespace trocar::device
