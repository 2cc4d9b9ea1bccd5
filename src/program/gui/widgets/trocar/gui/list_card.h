// SPDX-License-Identifier: Apache-2.0
/// \file list_card.h  A card over the picture with rows to choose from.
#pragma once

#include <gtkmm.h>

#include <filesystem>
#include <initializer_list>

namespace trocar::gui {

class ListCard : public Gtk::Box {
 public:
  /// \param width  of the rows [pixels]
  explicit ListCard(int width);

  sigc::signal<void()>& SignalClosed() { return signal_closed_; }

 protected:
  void ClearRows();
  void AddTitle(const Glib::ustring& text);
  /// A name over a line of smaller text, and widgets beside them.
  void AddRow(const std::string& name, const std::string& about, std::initializer_list<Gtk::Widget*> beside);
  /// As AddRow, with a picture before the lines; an empty frame where there is none.
  void AddPictureRow(const std::filesystem::path& picture, const std::string& name,
                     std::initializer_list<Gtk::Widget*> lines, std::initializer_list<Gtk::Widget*> beside);
  /// The line below the rows: widgets, and the button that closes the card at its end.
  void AddFoot(std::initializer_list<Gtk::Widget*> widgets);

 private:
  Gtk::Box rows_{Gtk::Orientation::VERTICAL};
  sigc::signal<void()> signal_closed_;
};

}  // namespace trocar::gui
