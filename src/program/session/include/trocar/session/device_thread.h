// SPDX-License-Identifier: Apache-2.0
/// \file device_thread.h  A device on a thread of its own: neither setting it up nor finding it again holds anybody up.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "trocar/device/jaw_sensor.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/device/ports.h"
#include "trocar/scene/scene.h"
#include "trocar/session/device_hands.h"

namespace trocar::session {

/// Tells a device that knows motion only where the scene's instruments start. Call it before the device is used.
void PlaceAtHome(const scene::Scene& scene, device::Driver& driver) noexcept;

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

/// Reads a driver 500 times a second. A device that is lost, or was not there at the start, is tried again every half
/// second. It comes back as an input only: nothing that a person has to switch on is switched on again from here.
class DeviceThread {
 public:
  /// \param driver   unconfigured, of device::kChannelCount channels; uses device::SystemClock()
  /// \param buttons  what its buttons do
  explicit DeviceThread(std::unique_ptr<device::Driver> driver,
                        const device::ButtonMap& buttons = device::DefaultButtons());
  ~DeviceThread();
  DeviceThread(const DeviceThread&) = delete;
  DeviceThread& operator=(const DeviceThread&) = delete;

  /// The newest report, valid until the next call. Called from one thread.
  const DeviceReport& Latest();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::session
