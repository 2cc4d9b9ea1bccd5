// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/over_card.h"

#include <algorithm>

namespace trocar::gui {

Gtk::ScrolledWindow& AddOverCard(Gtk::Overlay& overlay, Gtk::Widget& card) {
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::AUTOMATIC, Gtk::PolicyType::AUTOMATIC);
  scroller->set_propagate_natural_width(true);
  scroller->set_propagate_natural_height(true);
  scroller->set_halign(Gtk::Align::CENTER);
  scroller->set_valign(Gtk::Align::CENTER);
  scroller->set_visible(card.get_visible());
  card.property_visible().signal_changed().connect(
      [scroller, &card] { scroller->set_visible(card.get_visible()); });
  scroller->set_child(card);
  overlay.add_overlay(*scroller);
  return *scroller;
}

void FitToScreen(Gtk::Window& window, int width, int height) {
  const auto monitors = window.get_display()->get_monitors();
  const auto first = std::dynamic_pointer_cast<Gdk::Monitor>(monitors->get_object(0));
  if (first) {
    Gdk::Rectangle screen;
    first->get_geometry(screen);
    width = std::min(width, screen.get_width()), height = std::min(height, screen.get_height());
  }
  window.set_default_size(width, height);
}

}  // namespace trocar::gui
