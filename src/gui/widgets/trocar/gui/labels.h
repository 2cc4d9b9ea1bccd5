// SPDX-License-Identifier: Apache-2.0
/// \file labels.h  Texts that change many times a second, set only where they differ.
#pragma once

#include <gtkmm.h>

#include <string>

namespace trocar::gui {

inline void SetText(Gtk::Label& label, const std::string& text) {
  if (label.get_text().raw() != text) label.set_text(text);
}

/// Likewise; an empty text hides the label.
inline void SetTextOrHide(Gtk::Label& label, const std::string& text) {
  SetText(label, text);
  if (label.get_visible() == text.empty()) label.set_visible(!text.empty());
}

inline void SetClass(Gtk::Widget& widget, const char* name, bool is_on) {
  is_on ? widget.add_css_class(name) : widget.remove_css_class(name);
}

}  // namespace trocar::gui
