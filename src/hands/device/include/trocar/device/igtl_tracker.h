// SPDX-License-Identifier: Apache-2.0
/// \file igtl_tracker.h  Hands from any tracker that OpenIGTLink reaches: PLUS, 3D Slicer, a camera's own server.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "trocar/device/igtl.h"
#include "trocar/device/ports.h"
#include "trocar/device/pose_driver.h"

namespace trocar::device {

struct IgtlSettings {
  /// A pose whose name begins so, in capitals or not, is that hand's sensor.
  std::array<std::string, kChannelCount> names{"left", "right", "laparoscope"};
  double answer_time = 2.0;  ///< within which the first pose comes [s], > 0
  TrackedHandsSettings hands;
};

/// A client. Takes what IgtlReader reads, passes other messages over, closes the connection at a size that is a lie.
class IgtlTracker : public PoseDriver {
 public:
  /// \param clock  outlives the driver
  IgtlTracker(const IgtlSettings& settings, TransportOpener opener, Clock& clock);

  const math::Pose* GetSensorPose(int channel) const noexcept override { return hands_.GetPose(channel); }
  PoseCounts GetPoseCounts() const noexcept override { return hands_.Counts(); }
  std::vector<std::string> DescribeHeldBack() const override { return reader_.DescribeRefused(); }
  std::string DescribeReceived() const override { return reader_.DescribeReceived(); }
  const IgtlCounts& GetMessageCounts() const noexcept { return reader_.Counts(); }

 private:
  base::Status DoConfigure() override;
  base::Status DoActivate() override;
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override { transport_.reset(); }
  ReadStatus DoRead(std::span<HandSample> samples) noexcept override;

  bool Drain(const IgtlReader::Sink& sink);
  int FindChannel(std::string_view name) const noexcept;
  base::Error NoPose() const;

  IgtlSettings settings_;
  TransportOpener opener_;
  Clock& clock_;
  std::unique_ptr<Transport> transport_;
  IgtlReader reader_;
  TrackedHands hands_;
  double last_pose_ = 0;  // [s]
};

}  // namespace trocar::device
