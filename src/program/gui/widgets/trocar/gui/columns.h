// SPDX-License-Identifier: Apache-2.0
/// \file columns.h  Widgets side by side where there is room, else one below the other.
#pragma once

#include <gtkmm.h>

#include <vector>

namespace trocar::gui {

class Columns : public Gtk::Widget {
 public:
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
  /// Widths side by side, which share what is left over; empty where they do not fit.
  std::vector<int> FindWidths(const std::vector<Gtk::Widget*>& shown, int width) const;

  int spacing_;
};

}  // namespace trocar::gui
