// SPDX-License-Identifier: Apache-2.0
/// \file force_device_spec.h  Haptic devices by the name that a command line gives.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/device/force_driver.h"

namespace trocar::device {

/// - "simulated": two devices that move slowly and whose buttons nobody presses
/// - "simulated:held": the same in the hands of somebody who answers the check pose in the first 3 s, left and right, then
///   holds the safety switches
/// - "openhaptics", "openhaptics:Left,Right": by the names that the maker's program gave them
/// - "haply", "haply:2", "haply:2:10001": how many, and the port of the maker's service on this machine
///
/// \return unconfigured; kDeviceSettings with the kinds that there are
base::Result<std::unique_ptr<ForceDriver>> MakeForceDriver(std::string_view text);

/// Port of Haply's service, where none is given.
inline constexpr int kHaplyPort = 10001;
/// Where the maker's library lies among the folders that libraries are loaded from; empty where it is not. Loads nothing.
std::string FindOpenHaptics();

/// The kinds, for help and messages.
std::string ListForceDrivers();

}  // namespace trocar::device
