// SPDX-License-Identifier: Apache-2.0
/// \file series_bar.h  Asks for size and place of pictures that do not say them.
#pragma once

#include <gtkmm.h>

#include <array>

#include "trocar/editor/series_form.h"

namespace trocar::editor {

class SeriesBar : public Gtk::Box {
 public:
  SeriesBar();

  /// Shows the fields with what is known of `series`.
  void Ask(const images::ImageSeriesOptions& series);
  /// Fills the fields, as a hand would.
  void Fill(const SeriesForm& form);
  /// Reads the fields: sends what they say, or shows which one is wrong.
  void Answer();
  /// Complaint about the fields; empty if they are valid.
  std::string Complaint() const { return complaint_.get_text().raw(); }
  sigc::signal<void(images::ImageSeriesOptions)>& SignalAnswered() { return signal_answered_; }

 private:
  images::ImageSeriesOptions series_;
  Gtk::Entry pixel_, slice_;
  std::array<Gtk::DropDown, 3> axes_;
  Gtk::Label complaint_;
  sigc::signal<void(images::ImageSeriesOptions)> signal_answered_;
};

}  // namespace trocar::editor
