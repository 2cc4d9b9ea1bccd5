// SPDX-License-Identifier: Apache-2.0
/// \file look.h  Dark theme of the windows.
#pragma once

#include <filesystem>

namespace trocar::gui {

/// The style sheet, in the data folder.
inline constexpr const char* kLookFile = "assets/looks/window.css";

/// Style sheet for the whole display. A display must be open. Without the file, GTK's dark theme and a warning.
void ApplyLook(const std::filesystem::path& data_folder);

}  // namespace trocar::gui
