// SPDX-License-Identifier: Apache-2.0
/// \file card.h  Building blocks of panels: cards with a title, lines of a name and a value, texts of a style.
#pragma once

#include <gtkmm.h>

#include <initializer_list>
#include <string>

namespace trocar::gui {

/// A part of a panel, with a title.
class Card : public Gtk::Box {
 public:
  /// \param title    null: none
  /// \param spacing  between its lines [pixels]
  explicit Card(const char* title, int spacing = 2);

  /// A line of a name and a value that changes.
  /// \return the value, which lives as long as the card
  Gtk::Label& AddLine(const char* name, const char* tip);
  /// Puts a widget beside the title.
  void SetTitleEnd(Gtk::Widget& widget);

 private:
  Gtk::Box title_line_;
  Gtk::Label title_;
};

/// Sets how a label looks: class of the style sheet, and the side on which its text stands.
void SetStyle(Gtk::Label& label, const char* style, Gtk::Align align = Gtk::Align::START);
/// Lets a text take the panel's width and as many lines as it needs.
void Wrap(Gtk::Label& label);
/// A label that its parent owns; it takes another line where there is no room.
Gtk::Label* MakeLabel(const std::string& text, const char* style);
/// Widgets side by side; its parent owns it.
Gtk::Box& MakeRow(int spacing, std::initializer_list<Gtk::Widget*> widgets);

}  // namespace trocar::gui
