// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/look.h"

#include <gtkmm.h>

#include "trocar/host/log.h"

namespace trocar::gui {

namespace {

bool HasHighContrastTheme() {
  const std::string theme = Gtk::Settings::get_default()->property_gtk_theme_name().get_value();
  return theme.find("HighContrast") != std::string::npos || theme.find("-hc") != std::string::npos;
}

void Apply(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(file, failure)) {
    host::Log(host::LogLevel::kWarning, "the windows have GTK's own look: " + file.string() +
                                            " is missing; `trocar doctor` checks the data");
    return;
  }
  const auto style = Gtk::CssProvider::create();
  style->load_from_path(file.string());
  Gtk::StyleContext::add_provider_for_display(Gdk::Display::get_default(), style,
                                              GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
}

}  // namespace

void ApplyLook(const std::filesystem::path& data_folder, bool is_high_contrast) {
  Gtk::Settings::get_default()->property_gtk_application_prefer_dark_theme() = true;
  const bool is_strong = is_high_contrast || HasHighContrastTheme();
  Apply(data_folder / kLookFile);
  if (is_strong) Apply(data_folder / kHighContrastFile);
}

}  // namespace trocar::gui
