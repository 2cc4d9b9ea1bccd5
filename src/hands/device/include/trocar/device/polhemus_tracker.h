// SPDX-License-Identifier: Apache-2.0
/// \file polhemus_tracker.h  Hands from a Polhemus tracker on a serial line.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "trocar/device/polhemus.h"
#include "trocar/device/ports.h"
#include "trocar/device/pose_driver.h"

namespace trocar::device {

struct PolhemusSettings {
  PolhemusFormat format = PolhemusFormat::kFastrakAscii;
  /// Station of each hand: left, right, laparoscope; 0 for none. No station twice.
  std::array<int, kChannelCount> stations{1, 2, 0};
  double answer_time = 1.0;  ///< within which the tracker answers when it is set up [s], > 0
  TrackedHandsSettings hands;
};

/// Sets the tracker up, asks every station for one record, then lets it send without being asked.
///
/// A hand is not seen after `stale_after` without a good record of its station; the tracker is lost when it hangs up or
/// sends nothing readable for `lost_after`. It never comes back by itself: Configure() opens the line anew.
class PolhemusTracker : public PoseDriver {
 public:
  /// \param clock  outlives the driver
  PolhemusTracker(const PolhemusSettings& settings, TransportOpener opener, Clock& clock);

  const math::Pose* GetSensorPose(int channel) const noexcept override { return hands_.GetPose(channel); }
  PoseCounts GetPoseCounts() const noexcept override { return hands_.Counts(); }
  const FramerCounts& GetFramerCounts() const noexcept { return framer_.Counts(); }
  /// Records in which the tracker itself reported an error, and records of stations that no hand uses.
  std::uint64_t GetErrorCount() const noexcept { return errors_; }

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override;
  void DoCleanup() noexcept override;
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  base::Status CheckSettings() const;
  base::Status AskStations(const std::vector<int>& stations, bool is_first);
  base::Status AwaitStations();
  int FindChannel(int station) const noexcept;

  PolhemusSettings settings_;
  TransportOpener opener_;
  Clock& clock_;
  std::unique_ptr<Transport> transport_;
  PolhemusFramer framer_;
  TrackedHands hands_;
  double last_record_ = 0;  // [s]
  std::uint64_t errors_ = 0;
};

}  // namespace trocar::device
