// SPDX-License-Identifier: Apache-2.0
/// \file fold_row.h  Widgets in a line; where there is no room, some give way, and a button at the end holds them.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <limits>
#include <vector>

namespace trocar::gui {

class FoldRow : public Gtk::Widget {
 public:
  static constexpr int kSpare = std::numeric_limits<int>::max();

  FoldRow();
  ~FoldRow() override;

  /// \param child  outlives the row or is managed by it
  /// \param order  0: it never gives way; else those of the greatest order give way first; kSpare: nobody misses it
  void Append(Gtk::Widget& child, int order);
  /// Begins the half that stands at the end of the line.
  void BeginEnd() { end_begins_ = children_.size(); }
  /// Whether there was no room for it.
  bool IsFolded(const Gtk::Widget& child) const;
  /// Asked, when a person opens the button at the end, what lies in it.
  void SetMaker(std::function<Gtk::Widget*()> make) { make_ = std::move(make); }
  void CloseMore() { more_.popdown(); }

 protected:
  Gtk::SizeRequestMode get_request_mode_vfunc() const override;
  void measure_vfunc(Gtk::Orientation orientation, int for_size, int& minimum, int& natural,
                     int& minimum_baseline, int& natural_baseline) const override;
  void size_allocate_vfunc(int width, int height, int baseline) override;

 private:
  struct Child {
    Gtk::Widget* widget;
    int order;
    bool is_folded = false;
  };
  void Fold(int width, int height);
  bool HasFolded() const;
  void LetGo();

  std::vector<Child> children_;
  std::size_t end_begins_ = static_cast<std::size_t>(-1);
  Gtk::MenuButton more_;
  Gtk::Popover popover_;
  std::function<Gtk::Widget*()> make_;
};

}  // namespace trocar::gui
