// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/layout_walk.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace trocar::gui {
namespace {

/// Rounding of places that are not whole pixels [pixels].
constexpr double kSlack = 1.5;

/// A part of the window in which a widget is seen or can be scrolled to.
struct Room {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool scrolls_across = false, scrolls_down = false;
};

std::string NameOf(Gtk::Widget& widget) {
  std::string name = G_OBJECT_TYPE_NAME(widget.gobj());
  for (const Glib::ustring& style : widget.get_css_classes()) name += "." + style.raw();
  return name;
}

bool IsSeen(Gtk::Widget& widget) {
  return widget.get_mapped() && widget.get_child_visible() && widget.get_width() > 0 &&
         widget.get_height() > 0;
}

using Visit = std::function<void(Gtk::Widget&, const std::string& path, const Room& room)>;

void Walk(Gtk::Widget& widget, Gtk::Window& window, const std::string& path, Room room, const Visit& visit) {
  if (!IsSeen(widget)) return;
  const std::string own = path.empty() ? NameOf(widget) : path + " > " + NameOf(widget);
  visit(widget, own, room);
  if (auto* scroller = dynamic_cast<Gtk::ScrolledWindow*>(&widget)) {
    Gtk::PolicyType across{}, down{};
    scroller->get_policy(across, down);
    room.scrolls_across = room.scrolls_across || across != Gtk::PolicyType::NEVER;
    room.scrolls_down = room.scrolls_down || down != Gtk::PolicyType::NEVER;
  }
  for (Gtk::Widget* child = widget.get_first_child(); child != nullptr; child = child->get_next_sibling()) {
    // a popup is a window of its own
    if (dynamic_cast<Gtk::Popover*>(child) == nullptr) Walk(*child, window, own, room, visit);
  }
}

void WalkWindow(Gtk::Window& window, const Visit& visit) {
  const Room room{
      0, 0, static_cast<double>(window.get_width()), static_cast<double>(window.get_height()), false, false};
  Walk(window, window, "", room, visit);
}

/// How much of a label's text its place does not hold [pixels].
int CutOff(Gtk::Label& label) {
  const auto layout = label.get_layout();
  if (!layout || label.get_text().empty()) return 0;
  int width = 0, height = 0;
  layout->get_pixel_size(width, height);
  if (layout->is_ellipsized()) return std::max(1, width);
  return std::max({0, width - label.get_width(), height - label.get_height()});
}

}  // namespace

std::vector<Misfit> FindMisfits(Gtk::Window& window, int width, int height) {
  std::vector<Misfit> misfits;
  const int over = std::max(window.get_width() - width, window.get_height() - height);
  if (over > 0) misfits.push_back({"window larger than the screen", NameOf(window), "", over});
  WalkWindow(window, [&](Gtk::Widget& widget, const std::string& path, const Room& room) {
    auto* label = dynamic_cast<Gtk::Label*>(&widget);
    const std::string text = label != nullptr ? label->get_text().raw() : "";
    if (label != nullptr) {
      if (const int cut = CutOff(*label); cut > kSlack) misfits.push_back({"text cut off", path, text, cut});
    }
    double x = 0, y = 0;
    if (!widget.translate_coordinates(window, 0, 0, x, y)) return;
    double beyond = 0;
    if (!room.scrolls_across) beyond = std::max({beyond, room.left - x, x + widget.get_width() - room.right});
    if (!room.scrolls_down) beyond = std::max({beyond, room.top - y, y + widget.get_height() - room.bottom});
    if (beyond > kSlack)
      misfits.push_back({"off the window", path, text, static_cast<int>(std::lround(beyond))});
  });
  return misfits;
}

std::size_t CountSeen(Gtk::Window& window) {
  std::size_t count = 0;
  WalkWindow(window, [&](Gtk::Widget&, const std::string&, const Room&) { ++count; });
  return count;
}

std::vector<std::string> ListTexts(Gtk::Window& window) {
  std::vector<std::string> texts;
  WalkWindow(window, [&](Gtk::Widget& widget, const std::string&, const Room&) {
    auto* label = dynamic_cast<Gtk::Label*>(&widget);
    if (label != nullptr && !label->get_text().empty()) texts.push_back(label->get_text().raw());
  });
  return texts;
}

}  // namespace trocar::gui
