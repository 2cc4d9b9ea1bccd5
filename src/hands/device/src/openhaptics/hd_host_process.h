// SPDX-License-Identifier: Apache-2.0
/// \file hd_host_process.h  Work of the process of a maker's library, and of the supervisor's process in its place.
#pragma once

#include <string>
#include <string_view>

namespace trocar::device {

/// Longest that is waited for a killed process's end, before which its devices open for nobody else [ms]; one that hangs in a driver
/// of the system takes longer.
inline constexpr int kEndTime = 500;

/// Opens the devices, sends them zero and gives them back.
/// \param request  "file\nname\n..."
/// \return exit status; 0: zero has been sent
int SendZeroOnce(const std::string& request) noexcept;

}  // namespace trocar::device
