// SPDX-License-Identifier: Apache-2.0
/// \file hand_recording.h  Recording of a device's samples, kept in a file and played again in its place.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/device/driver.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/device/ports.h"

namespace trocar::device {

struct HandFrame {
  double time = 0;  ///< since the start of the recording [s]
  std::array<HandSample, kChannelCount> hands;

  friend bool operator==(const HandFrame&, const HandFrame&) = default;
};

/// Text that a spreadsheet opens: a line of columns, then one line a frame, comma-separated; angles in rad, lengths in m.
/// Numbers are written so that reading gives the same bits.
std::string FormatHandFrames(const std::vector<HandFrame>& frames);
/// \param name  in messages
/// \return kDeviceSettings with the number of the line: times must not fall, numbers must be finite and of a hand
base::Result<std::vector<HandFrame>> ParseHandFrames(std::string_view text, const std::string& name);

/// Plays a recording: the newest frame up to now, from the moment it is activated; holds the last one at the end.
///
/// A recording may have been made of anything, by hand too. A hand goes from where it was placed to where the recording wants
/// it no faster than a tracker's may (kMaxPlaySpeed, kMaxPlayTurnRate); what is slower passes bit for bit.
inline constexpr double kMaxPlaySpeed = 2.0;      ///< of a tip [m/s]
inline constexpr double kMaxPlayTurnRate = 25.0;  ///< of shaft and jaws [rad/s]
class HandPlayer : public Driver {
 public:
  /// The file is read when the player is configured.
  /// \param clock  outlives the driver
  HandPlayer(std::filesystem::path path, Clock& clock);

  void PlaceHand(int channel, const HandSample& home) noexcept override;
  /// [s]
  double Duration() const noexcept { return frames_.empty() ? 0.0 : frames_.back().time; }

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override {}
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  std::filesystem::path path_;
  Clock& clock_;
  std::vector<HandFrame> frames_;
  double start_ = 0;      // [s]
  std::size_t next_ = 0;  // frame that has not been played
  double last_ = 0;       // Read [s]
  std::array<HandSample, kChannelCount> homes_, hands_;
  std::array<bool, kChannelCount> is_placed_{}, is_known_{};  // homes_, hands_
};

}  // namespace trocar::device
