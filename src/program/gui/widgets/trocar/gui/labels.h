// SPDX-License-Identifier: Apache-2.0
/// \file labels.h  Texts that change many times a second, set only where they differ.
#pragma once

#include <gtkmm.h>

#include <string>

namespace trocar::gui {

inline void SetText(Gtk::Label& label, const std::string& text) {
  if (label.get_text().raw() != text) label.set_text(text);
}

/// As SetText; an empty text hides the label.
inline void SetTextOrHide(Gtk::Label& label, const std::string& text) {
  SetText(label, text);
  if (label.get_visible() == text.empty()) label.set_visible(!text.empty());
}

/// Sets the name that a screen reader speaks for a widget whose text does not give it.
inline void SetAccessibleName(Gtk::Widget& widget, const std::string& name) {
  Glib::Value<Glib::ustring> value;
  value.init(Glib::Value<Glib::ustring>::value_type());
  value.set(name);
  widget.update_property(Gtk::Accessible::Property::LABEL, value);
}

inline void SetClass(Gtk::Widget& widget, const char* name, bool is_on) {
  is_on ? widget.add_css_class(name) : widget.remove_css_class(name);
}

}  // namespace trocar::gui
