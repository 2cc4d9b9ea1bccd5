// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/force_device_spec.h"

#include <cmath>

#include "trocar/device/simulated_force_device.h"

namespace trocar::device {

std::string ListForceDrivers() {
  return "simulated";
}

core::Result<std::unique_ptr<ForceDriver>> MakeForceDriver(std::string_view text) {
  if (text == "simulated") {
    SimulatedForceSettings settings;
    settings.channel_count = 2;
    settings.path = [](int channel, double time) {
      const double side = channel == 0 ? -1.0 : 1.0;
      return math::Vec3{0.010 * side * std::sin(0.9 * time), 0.006 * std::sin(0.7 * time),
                        -0.015 * (1.0 - std::cos(0.5 * time))};
    };
    return std::unique_ptr<ForceDriver>(std::make_unique<SimulatedForceDevice>(settings));
  }
  return core::Error{
      core::ErrorCode::kDeviceSettings,
      "there is no haptic device of the kind \"" + std::string(text) + "\"; there is " + ListForceDrivers()};
}

}  // namespace trocar::device
