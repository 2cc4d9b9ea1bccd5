// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/fold_row.h"

#include <algorithm>

#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::gui {
namespace {

constexpr int kSpacing = 6;  // [pixels]

int NaturalWidth(const Gtk::Widget& widget, int height) {
  int minimum = 0, natural = 0, ignored = 0;
  widget.measure(Gtk::Orientation::HORIZONTAL, height, minimum, natural, ignored, ignored);
  return natural;
}

}  // namespace

FoldRow::FoldRow() {
  set_hexpand(true);
  // where its parent ends first, GTK ends it before its own destructor is called
  signal_destroy().connect([this] { LetGo(); });
  more_.set_label("\u22ef");
  more_.set_always_show_arrow(true);
  SetAccessibleName(more_, host::Translate("More"));
  more_.set_tooltip_text(host::Translate("What has no room in this line"));
  more_.set_popover(popover_);
  more_.set_focus_on_click(false);
  more_.set_parent(*this);
  popover_.signal_show().connect([this] {
    if (make_) popover_.set_child(*make_());
  });
}

FoldRow::~FoldRow() {
  if (gobj() != nullptr) LetGo();
}

void FoldRow::LetGo() {
  children_.clear();
  // those that are members of others may have gone before
  while (Gtk::Widget* child = get_first_child()) child->unparent();
}

void FoldRow::Append(Gtk::Widget& child, int order) {
  child.set_parent(*this);
  child.set_valign(Gtk::Align::CENTER);
  children_.push_back({&child, order});
}

bool FoldRow::IsFolded(const Gtk::Widget& child) const {
  return std::any_of(children_.begin(), children_.end(),
                     [&](const Child& one) { return one.widget == &child && one.is_folded; });
}

bool FoldRow::HasFolded() const {
  return std::any_of(children_.begin(), children_.end(),
                     [](const Child& child) { return child.is_folded && child.order != kSpare; });
}

Gtk::SizeRequestMode FoldRow::get_request_mode_vfunc() const {
  return Gtk::SizeRequestMode::CONSTANT_SIZE;
}

void FoldRow::measure_vfunc(Gtk::Orientation orientation, int for_size, int& minimum, int& natural,
                            int& minimum_baseline, int& natural_baseline) const {
  minimum_baseline = natural_baseline = -1;
  if (orientation == Gtk::Orientation::HORIZONTAL) {
    // the button at the end holds all that may give way
    minimum = NaturalWidth(more_, for_size);
    natural = 0;
    for (const Child& child : children_) {
      if (!child.widget->get_visible()) continue;
      const int width = NaturalWidth(*child.widget, for_size) + kSpacing;
      natural += width;
      if (child.order == 0) minimum += width;
    }
    natural = std::max(natural, minimum);
    return;
  }
  minimum = natural = 0;
  const auto take = [&](const Gtk::Widget& widget) {
    int least = 0, wanted = 0, ignored = 0;
    widget.measure(orientation, -1, least, wanted, ignored, ignored);
    minimum = std::max(minimum, least), natural = std::max(natural, wanted);
  };
  take(more_);
  for (const Child& child : children_) {
    if (child.widget->get_visible()) take(*child.widget);
  }
}

/// Decides who gives way.
void FoldRow::Fold(int width, int height) {
  std::vector<Child*> shown;
  int total = 0;
  for (Child& child : children_) {
    child.is_folded = false;
    if (!child.widget->get_visible()) continue;
    total += NaturalWidth(*child.widget, height) + kSpacing;
    shown.push_back(&child);
  }
  std::stable_sort(shown.begin(), shown.end(),
                   [](const Child* a, const Child* b) { return a->order > b->order; });
  for (Child* child : shown) {
    // what nobody misses leaves no button behind
    const int room = child->order == kSpare || !HasFolded() ? width : width - NaturalWidth(more_, height);
    if (total <= room || child->order == 0) return;
    total -= NaturalWidth(*child->widget, height) + kSpacing;
    child->is_folded = true;
  }
}

void FoldRow::size_allocate_vfunc(int width, int height, int baseline) {
  Fold(width, height);
  const bool has_folded = HasFolded();
  int end_width = 0;
  for (std::size_t i = end_begins_; i < children_.size(); ++i) {
    const Child& child = children_[i];
    if (child.widget->get_visible() && !child.is_folded)
      end_width += NaturalWidth(*child.widget, height) + kSpacing;
  }
  const int more_width = has_folded ? NaturalWidth(more_, height) : 0;
  more_.set_child_visible(has_folded);
  if (has_folded) more_.size_allocate({width - more_width, 0, more_width, height}, baseline);
  int x = 0;
  for (std::size_t i = 0; i < children_.size(); ++i) {
    if (i == end_begins_) x = std::max(x, width - more_width - end_width);
    Child& child = children_[i];
    const bool is_here = child.widget->get_visible() && !child.is_folded;
    child.widget->set_child_visible(is_here);
    if (!is_here) continue;
    const int own = NaturalWidth(*child.widget, height);
    child.widget->size_allocate({x, 0, own, height}, baseline);
    x += own + kSpacing;
  }
}

}  // namespace trocar::gui
