// SPDX-License-Identifier: Apache-2.0
/// \file haply_messages.h  JSON that the Inverse3's service sends and takes. Device frame as in force_driver.h.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/math/pose.h"

namespace trocar::device::haply {

inline constexpr std::size_t kMaxDevices = 2;

struct DeviceState {
  std::string id;
  math::Vec3 position;  ///< [m]
};
struct State {
  std::vector<DeviceState> devices;  ///< at most kMaxDevices, in the service's order
  math::Quaternion grip;  ///< of the first grip as it is reported, of any length; the identity without one
  std::uint32_t buttons = 0;  ///< of that grip: a, b, c from bit 0 on
};

/// Positions and orientation are what the service says, whether or not a device can be there.
/// \return false where the text is no state: not JSON, or no numbers
bool ParseState(std::string_view text, State& state);
std::string FormatState(const State& state);

/// \param ids     (n) of the devices
/// \param forces  (n) [N]
std::string FormatForces(const std::vector<std::string>& ids,
                         const std::array<math::Vec3, kMaxDevices>& forces);
/// The forces of such a message, for the emulator; false where it is none.
bool ParseForces(std::string_view text, std::vector<std::string>& ids,
                 std::array<math::Vec3, kMaxDevices>& forces);

}  // namespace trocar::device::haply
