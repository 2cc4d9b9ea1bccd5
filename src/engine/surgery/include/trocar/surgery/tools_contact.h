// SPDX-License-Identifier: Apache-2.0
/// \file tools_contact.h  Tool against tool: two shafts that cross push each other and do not pass.
#pragma once

#include <array>

#include "trocar/surgery/tool_proxy.h"

namespace trocar::surgery {

/// Stiffness with which two tools that meet push their hands apart [N/m].
inline constexpr double kToolsStiffness = 1000.0;

/// How two tools met in a tick.
struct ToolsContact {
  std::array<math::Vec3, 2> force;  ///< on each tool, equal and opposite [N]
  bool is_touching = false;         ///< the devices overlap, or would have passed through each other
};

/// Follows both tools from proxy to device, adds a limit to each proxy where they meet (each gives way by half),
/// and finds the force.
/// \note Real-time safe.
ToolsContact FindToolsContact(const std::array<ToolMotion, 2>& motions,
                              std::array<ProxyLimits, 2>& limits) noexcept;

}  // namespace trocar::surgery
