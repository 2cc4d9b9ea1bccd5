// SPDX-License-Identifier: Apache-2.0
/// \file columns.h  Widgets side by side, in as many rows as the width asks for.
#pragma once

#include <gtkmm.h>

#include <vector>

namespace trocar::gui {

class Columns : public Gtk::Widget {
 public:
  struct Size {
    int minimum = 0, natural = 0;  ///< [pixels]
  };

  /// \param spacing  between them [pixels]
  explicit Columns(int spacing);
  ~Columns() override;
  /// \param child  managed, or outlives this
  void Append(Gtk::Widget& child);

 protected:
  Gtk::SizeRequestMode get_request_mode_vfunc() const override;
  void measure_vfunc(Gtk::Orientation orientation, int for_size, int& minimum, int& natural,
                     int& minimum_baseline, int& natural_baseline) const override;
  void size_allocate_vfunc(int width, int height, int baseline) override;

 private:
  std::vector<Gtk::Widget*> Shown() const;
  void LetGo();
  std::vector<std::vector<Gtk::Widget*>> FindRows(int width) const;
  Size MeasureRow(const std::vector<Gtk::Widget*>& row, int width) const;
  /// Widths of a row, which share what is left over; empty where they do not fit.
  std::vector<int> FindWidths(const std::vector<Gtk::Widget*>& shown, int width) const;

  int spacing_;
};

}  // namespace trocar::gui
