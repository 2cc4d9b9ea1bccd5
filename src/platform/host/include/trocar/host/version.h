// SPDX-License-Identifier: Apache-2.0
/// \file version.h  Version of the program.
#pragma once

#include <string_view>

namespace trocar::host {

/// "0.1.0"
std::string_view VersionText() noexcept;

}  // namespace trocar::host
