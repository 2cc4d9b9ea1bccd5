// SPDX-License-Identifier: Apache-2.0
/// \file device_input.h  A device's hands in place of a script's, for runs without a window.
#pragma once

#include <memory>
#include <string>

#include "trocar/base/result.h"
#include "trocar/device/driver.h"
#include "trocar/device/ports.h"
#include "trocar/scene/scene.h"
#include "trocar/session/hand_device.h"

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11 calls it so
class App;
}

namespace trocar::cli {

/// --device of the commands that play a scene's script.
/// \param[out] spec  as DeviceInput::Open() takes it; lives as long as the command
void AddDeviceOption(CLI::App& command, std::string& spec);

/// A recording (play:FILE) runs on simulated time: the same file gives the same bits. Any other device runs in real time.
class DeviceInput final : public session::HandDevice {
 public:
  /// \return the device's error
  static base::Result<std::unique_ptr<DeviceInput>> Open(const std::string& spec, const scene::Scene& scene);

  /// Says in the log what came in and was not used, as Look() does as soon as it is so.
  ~DeviceInput() override;

  /// With a real device, waits until so much time [s] has passed since Open().
  void Await(double time);
  /// Reads the device. Once it is lost, hands are where they were last seen, and every pedal is up.
  /// \param time  of the tick [s]
  const session::DeviceReport& Look(double time) override;
  /// kDeviceLost once the device was lost.
  base::Status Check() const;

 private:
  DeviceInput() = default;
  void TellHeldBack();

  device::ManualClock simulated_;
  device::Clock* clock_ = nullptr;
  double start_ = 0;  // [s]
  std::unique_ptr<device::Driver> driver_;
  device::HandButtons buttons_;
  session::DeviceReport report_;
  double next_look_ = 0;  // at what was held back [s]
  std::size_t told_ = 0;  // reasons of it
};

}  // namespace trocar::cli
