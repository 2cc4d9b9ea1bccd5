// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/columns.h"

#include <algorithm>

namespace trocar::gui {
namespace {

Columns::Size Measure(const Gtk::Widget& widget, Gtk::Orientation orientation, int for_size) {
  Columns::Size size;
  int ignored = 0;
  widget.measure(orientation, for_size, size.minimum, size.natural, ignored, ignored);
  return size;
}

}  // namespace

Columns::Columns(int spacing) : spacing_(spacing) {
  set_hexpand(true);
  // where its parent ends first, GTK ends it before its own destructor is called
  signal_destroy().connect([this] { LetGo(); });
}

Columns::~Columns() {
  if (gobj() != nullptr) LetGo();
}

void Columns::LetGo() {
  // those that are members of others may have gone before
  while (Gtk::Widget* child = get_first_child()) child->unparent();
}

void Columns::Append(Gtk::Widget& child) {
  child.set_parent(*this);
}

std::vector<Gtk::Widget*> Columns::Shown() const {
  std::vector<Gtk::Widget*> shown;
  for (const Gtk::Widget* child = get_first_child(); child != nullptr; child = child->get_next_sibling()) {
    if (child->get_visible()) shown.push_back(const_cast<Gtk::Widget*>(child));
  }
  return shown;
}

std::vector<int> Columns::FindWidths(const std::vector<Gtk::Widget*>& shown, int width) const {
  std::vector<Size> sizes;
  int used = 0, expanding = 0, wish = 0;
  for (Gtk::Widget* child : shown) {
    sizes.push_back(Measure(*child, Gtk::Orientation::HORIZONTAL, -1));
    used += sizes.back().minimum + (sizes.size() > 1 ? spacing_ : 0);
    wish += sizes.back().natural - sizes.back().minimum;
    expanding += child->compute_expand(Gtk::Orientation::HORIZONTAL) ? 1 : 0;
  }
  if (used > width) return {};
  // what is left over goes to whoever would like more, in proportion; and what nobody needs, to whoever takes it
  const int left = width - used, given = std::min(left, wish);
  std::vector<int> widths;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto more = static_cast<double>(sizes[i].natural - sizes[i].minimum);
    widths.push_back(sizes[i].minimum + (wish > 0 ? static_cast<int>(more * given / wish) : 0));
    if (expanding > 0 && shown[i]->compute_expand(Gtk::Orientation::HORIZONTAL))
      widths.back() += (left - given) / expanding;
  }
  return widths;
}

/// Those that stand side by side in so much width, row by row: as many as their least widths allow.
std::vector<std::vector<Gtk::Widget*>> Columns::FindRows(int width) const {
  std::vector<std::vector<Gtk::Widget*>> rows;
  int used = 0;
  for (Gtk::Widget* child : Shown()) {
    const int own = Measure(*child, Gtk::Orientation::HORIZONTAL, -1).minimum;
    if (rows.empty() || used + spacing_ + own > width) {
      rows.emplace_back();
      used = own;
    } else {
      used += spacing_ + own;
    }
    rows.back().push_back(child);
  }
  return rows;
}

Gtk::SizeRequestMode Columns::get_request_mode_vfunc() const {
  return Gtk::SizeRequestMode::HEIGHT_FOR_WIDTH;
}

void Columns::measure_vfunc(Gtk::Orientation orientation, int for_size, int& minimum, int& natural,
                            int& minimum_baseline, int& natural_baseline) const {
  minimum_baseline = natural_baseline = -1;
  minimum = natural = 0;
  const auto shown = Shown();
  if (orientation == Gtk::Orientation::HORIZONTAL) {
    for (const Gtk::Widget* child : shown) {
      const Size size = Measure(*child, orientation, -1);
      minimum = std::max(minimum, size.minimum);
      natural += size.natural + (child == shown.front() ? 0 : spacing_);
    }
    natural = std::max(natural, minimum);
    return;
  }
  // without a width: one below the other
  for (const auto& row : FindRows(std::max(for_size, 0))) {
    const Size size = MeasureRow(row, for_size);
    minimum += size.minimum + (row.front() == shown.front() ? 0 : spacing_);
    natural += size.natural + (row.front() == shown.front() ? 0 : spacing_);
  }
}

/// Height of a row.
Columns::Size Columns::MeasureRow(const std::vector<Gtk::Widget*>& row, int width) const {
  const std::vector<int> widths = FindWidths(row, width);
  Size height;
  for (std::size_t i = 0; i < row.size(); ++i) {
    // what is wider than all of it, and stands alone, is given what there is
    const Size own = Measure(*row[i], Gtk::Orientation::VERTICAL, widths.empty() ? width : widths[i]);
    height = {std::max(height.minimum, own.minimum), std::max(height.natural, own.natural)};
  }
  return height;
}

void Columns::size_allocate_vfunc(int width, int height, int baseline) {
  const auto rows = FindRows(width);
  int y = 0;
  for (const auto& row : rows) {
    const std::vector<int> widths = FindWidths(row, width);
    const int own = rows.size() == 1 ? height : MeasureRow(row, width).natural;
    int x = 0;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int across = widths.empty() ? width : widths[i];
      row[i]->size_allocate({x, y, across, own}, baseline);
      x += across + spacing_;
    }
    y += own + spacing_;
  }
}

}  // namespace trocar::gui
