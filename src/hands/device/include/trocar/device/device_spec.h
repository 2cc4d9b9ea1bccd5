// SPDX-License-Identifier: Apache-2.0
/// \file device_spec.h  Devices by name, as a person writes them: "liberty:/dev/ttyUSB0+jaw:/dev/ttyACM0".
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/device/device_store.h"
#include "trocar/device/driver.h"
#include "trocar/device/ports.h"
#include "trocar/device/pose_driver.h"

namespace trocar::device {

/// KIND, KIND:ADDRESS or KIND:ADDRESS,baud=SPEED.
struct DeviceSpec {
  std::string kind;
  std::string address;
  int baud = 0;  ///< 0: that of the store [bit/s]
};

/// One kind of device.
struct DeviceKind {
  std::string_view name;     ///< "liberty"
  std::string_view address;  ///< what its address is, or "" where it needs none
  std::string_view text;     ///< one line for a person
};
std::span<const DeviceKind> DeviceKinds() noexcept;

/// \return kUsage with the kinds there are
base::Result<DeviceSpec> ParseDeviceSpec(std::string_view text);

/// Hands as one driver of kChannelCount channels; with "+jaw:..." the jaws from there. Nothing is opened yet.
/// \param clock  outlives the driver
/// \return kUsage, kDeviceSettings or kDeviceUnsupported
base::Result<std::unique_ptr<Driver>> MakeDriver(std::string_view text, const DeviceStore& store,
                                                 Clock& clock);

/// Acts of a device's buttons, by the settings of its kind.
/// \param text  as MakeDriver() takes it
ButtonMap FindButtons(std::string_view text, const DeviceStore& store);

/// A tracker alone, for calibration.
/// \return kUsage also where the kind is no tracker
base::Result<std::unique_ptr<PoseDriver>> MakeTracker(std::string_view text, const DeviceStore& store,
                                                      Clock& clock);
/// A jaw sensor alone, for calibration; its stored calibration is left out.
base::Result<std::unique_ptr<JawSensor>> MakeJawSensor(std::string_view text, Clock& clock);

/// A device that could be used now.
struct FoundDevice {
  std::string spec;         ///< for MakeDriver(); "KIND:" stands open where the kind cannot be told
  std::string description;  ///< for a person
};
/// Devices that are plugged in. Opens nothing that could disturb a device.
std::vector<FoundDevice> ListDevices();

}  // namespace trocar::device
