// SPDX-License-Identifier: Apache-2.0
/// \file hand_device.h  A device that holds hands, as a tick sees it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "trocar/device/jaw_sensor.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/math/pose.h"
#include "trocar/session/device_hands.h"

namespace trocar::session {

/// State of a device.
struct DeviceReport {
  enum class Phase { kConnecting, kRunning, kLost };
  Phase phase = Phase::kConnecting;
  DeviceSamples samples;
  /// Buttons and pedals, debounced; all of them up once the device is lost, and until they have been let go of after it
  /// came back.
  DeviceActs acts;
  /// Raw values for calibration: pose of each hand's sensor in the source's frame where the device is a tracker, and each
  /// tool's unfiltered jaw value where it has a jaw sensor.
  std::array<std::optional<math::Pose>, device::kChannelCount> sensors;
  std::array<std::optional<int>, device::kJawTools> raw_jaws;
  std::uint64_t reads = 0;   ///< that brought something new
  std::uint64_t losses = 0;  ///< since the start
  std::string message;       ///< for a person: "liberty is connected", "E-DEV-001 ..."
};

class HandDevice {
 public:
  virtual ~HandDevice() = default;
  /// The newest report, valid until the next call. Called by one thread; does not wait.
  ///
  /// \param time  of the simulation [s]; a device that plays a recording is read at that time
  virtual const DeviceReport& Look(double time) = 0;
};

}  // namespace trocar::session
