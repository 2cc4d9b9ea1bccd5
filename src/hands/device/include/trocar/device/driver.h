// SPDX-License-Identifier: Apache-2.0
/// \file driver.h  The life of an input device: Unconfigured -> Inactive -> Active, and Finalized for good.
/// Source: life cycle of hardware components in ros2_control; a fault ends in a state that moves nothing.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/device/hand_sample.h"

namespace trocar::device {

enum class DriverState {
  kUnconfigured,  ///< nothing opened
  kInactive,      ///< opened and checked; no samples
  kActive,        ///< samples can be read
  kFinalized,     ///< closed for good
};
/// "unconfigured", "inactive", "active", "finalized"
std::string_view StateName(DriverState state) noexcept;

enum class ReadStatus {
  kFresh,      ///< samples are newer than those of the last Read
  kUnchanged,  ///< nothing new since the last Read; samples are the last ones
  kNotActive,  ///< the driver is not active; every sample is marked invalid
  kLost,       ///< the device is gone; every sample is marked invalid and the driver is unconfigured again
};

/// One input device. The public functions guard the life cycle; a device family fills in the private ones.
class Driver {
 public:
  virtual ~Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// Unconfigured -> Inactive.
  /// \return kDeviceState out of turn, or the device's own error (stays unconfigured)
  base::Status Configure();
  /// Inactive -> Active.
  /// \return kDeviceState out of turn, or the device's own error (stays inactive)
  base::Status Activate();
  /// Active -> Inactive.
  /// \return kDeviceState out of turn
  base::Status Deactivate();
  /// Inactive -> Unconfigured.
  /// \return kDeviceState out of turn
  base::Status Cleanup();
  /// Lets go of what a lost device still holds, which may take as long as its library does; nothing where there is none.
  /// Read() does it at once, ForceDriver leaves it to whoever has time; Configure() and Finalize() do it, too.
  void Release() noexcept;
  /// A lost device has not been let go of yet.
  bool NeedsRelease() const noexcept { return is_unreleased_; }
  /// Any state -> Finalized; a second call changes nothing.
  void Finalize() noexcept;

  /// Fetches the newest samples.
  ///
  /// \param[out] samples  (GetChannelCount()) one a hand, in the device's order
  /// \pre samples has exactly that size (TROCAR_ASSERT)
  /// \note Real-time safe: no allocation, lock or throw.
  ReadStatus Read(std::span<HandSample> samples) noexcept;

  /// Where a hand starts, for devices that know motion only. Devices that know places ignore it. Called before Activate().
  /// A sample that is not finite is ignored.
  virtual void PlaceHand(int /*channel*/, const HandSample& /*home*/) noexcept {}

  /// Input that was not used, where a person should know of it: a sentence for each reason, with what to do. English;
  /// TranslateComposed knows them. Another sentence means another reason; counts in them change.
  /// \note Not real-time safe: allocates.
  virtual std::vector<std::string> DescribeHeldBack() const { return {}; }
  /// Kinds, names and counts of all that came, where the device has such; no prose.
  /// \note Not real-time safe: allocates.
  virtual std::string DescribeReceived() const { return {}; }

  DriverState GetState() const noexcept { return state_; }
  /// Name for messages, for example "mouse and keyboard".
  const std::string& GetName() const noexcept { return name_; }
  int GetChannelCount() const noexcept { return channel_count_; }

 protected:
  Driver(std::string name, int channel_count) : name_(std::move(name)), channel_count_(channel_count) {}
  /// Active -> Unconfigured, because the device is gone; it never comes back by itself.
  /// \note Real-time safe.
  void Lose() noexcept;

 private:
  virtual base::Status DoConfigure() = 0;
  /// Judges what DoConfigure opened; an error closes it again.
  virtual base::Status CheckConfigured() const { return {}; }
  virtual base::Status DoActivate() = 0;
  virtual void DoDeactivate() noexcept = 0;
  virtual void DoCleanup() noexcept = 0;
  virtual ReadStatus DoRead(std::span<HandSample> samples) noexcept = 0;

  base::Status CheckTurn(DriverState needed, std::string_view wish) const;

  std::string name_;
  int channel_count_;
  DriverState state_ = DriverState::kUnconfigured;
  bool is_unreleased_ = false;
};

}  // namespace trocar::device
