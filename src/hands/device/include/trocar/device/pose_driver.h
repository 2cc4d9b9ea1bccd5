// SPDX-License-Identifier: Apache-2.0
/// \file pose_driver.h  Drivers that see poses of sensors: what calibration needs beside the hands.
#pragma once

#include "trocar/device/driver.h"
#include "trocar/device/tracked_hands.h"

namespace trocar::device {

class PoseDriver : public Driver {
 public:
  /// The last good pose of a hand's sensor in the source's frame; null before the first since Activate().
  virtual const math::Pose* GetSensorPose(int channel) const noexcept = 0;
  virtual PoseCounts GetPoseCounts() const noexcept = 0;

 protected:
  using Driver::Driver;
};

}  // namespace trocar::device
