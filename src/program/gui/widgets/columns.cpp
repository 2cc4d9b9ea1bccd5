// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/columns.h"

#include <algorithm>

namespace trocar::gui {
namespace {

struct Size {
  int minimum = 0, natural = 0;
};

Size Measure(const Gtk::Widget& widget, Gtk::Orientation orientation, int for_size) {
  Size size;
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
  const std::vector<int> widths = for_size < 0 ? std::vector<int>() : FindWidths(shown, for_size);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (!widths.empty()) {
      const Size size = Measure(*shown[i], orientation, widths[i]);
      minimum = std::max(minimum, size.minimum), natural = std::max(natural, size.natural);
    } else {
      const Size size = Measure(*shown[i], orientation, for_size);
      minimum += size.minimum + (i > 0 ? spacing_ : 0);
      natural += size.natural + (i > 0 ? spacing_ : 0);
    }
  }
}

void Columns::size_allocate_vfunc(int width, int height, int baseline) {
  const auto shown = Shown();
  const std::vector<int> widths = FindWidths(shown, width);
  int x = 0, y = 0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (!widths.empty()) {
      shown[i]->size_allocate({x, 0, widths[i], height}, baseline);
      x += widths[i] + spacing_;
    } else {
      const int own = Measure(*shown[i], Gtk::Orientation::VERTICAL, width).natural;
      shown[i]->size_allocate({0, y, width, own}, baseline);
      y += own + spacing_;
    }
  }
}

}  // namespace trocar::gui
