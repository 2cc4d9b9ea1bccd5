// SPDX-License-Identifier: Apache-2.0
/// \file look.h  Dark theme of the windows.
#pragma once

#include <filesystem>

namespace trocar::gui {

/// The style sheet, in the data folder.
inline constexpr const char* kLookFile = "assets/looks/window.css";

/// After it, for who needs strong contrast.
inline constexpr const char* kHighContrastFile = "assets/looks/high-contrast.css";

/// Style sheet for the whole display. A display must be open. Without the file, GTK's dark theme and a warning.
/// \param is_high_contrast  also where the desktop's theme is one of high contrast
void ApplyLook(const std::filesystem::path& data_folder, bool is_high_contrast);

}  // namespace trocar::gui
