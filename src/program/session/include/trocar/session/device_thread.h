// SPDX-License-Identifier: Apache-2.0
/// \file device_thread.h  A device on a thread of its own: neither setting it up nor finding it again holds anybody up.
#pragma once

#include <memory>

#include "trocar/device/ports.h"
#include "trocar/scene/scene.h"
#include "trocar/session/hand_device.h"

namespace trocar::session {

/// Tells a device that knows motion only where the scene's instruments start. Call it before the device is used.
void PlaceAtHome(const scene::Scene& scene, device::Driver& driver) noexcept;

/// Reads a driver 500 times a second. A device that is lost, or was not there at the start, is tried again every half
/// second. It comes back as an input only: nothing that a person has to switch on is switched on again from here.
class DeviceThread final : public HandDevice {
 public:
  /// \param driver   unconfigured, of device::kChannelCount channels; uses device::SystemClock()
  /// \param buttons  what its buttons do
  explicit DeviceThread(std::unique_ptr<device::Driver> driver,
                        const device::ButtonMap& buttons = device::DefaultButtons());
  ~DeviceThread() override;
  DeviceThread(const DeviceThread&) = delete;
  DeviceThread& operator=(const DeviceThread&) = delete;

  /// The newest report, valid until the next call. Called from one thread.
  const DeviceReport& Latest();
  /// As Latest(): the device has a clock of its own.
  const DeviceReport& Look(double /*time*/) override { return Latest(); }

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::session
