// SPDX-License-Identifier: Apache-2.0
/// \file window_screenshot.h  A window's picture as a PNG file.
#pragma once

#include <gtkmm.h>

#include <filesystem>

#include "trocar/base/result.h"

namespace trocar::gui {

/// Call it outside of a frame.
/// \return kFileUnwritable
base::Status SaveScreenshot(Gtk::Window& window, const std::filesystem::path& path);
/// As SaveScreenshot; false where the window has nothing to show yet, as while it is laid out anew.
base::Result<bool> TrySaveScreenshot(Gtk::Window& window, const std::filesystem::path& path);

/// A part of a window: what the widget shows, without what lies over it.
/// \return as SaveScreenshot
base::Status SaveWidgetPicture(Gtk::Widget& widget, const std::filesystem::path& path);

}  // namespace trocar::gui
