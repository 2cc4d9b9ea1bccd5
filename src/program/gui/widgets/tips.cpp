// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/tips.h"

namespace trocar::gui {

Tips::~Tips() {
  for (const auto& tip : tips_) tip->timer.disconnect();
}

void Tips::Set(Gtk::Widget& widget, const std::string& text) {
  widget.set_has_tooltip(true);
  for (const auto& tip : tips_) {
    if (tip->widget != &widget) continue;
    if (tip->text == text) return;
    tip->text = text;
    if (tip->timer.connected()) widget.trigger_tooltip_query();
    return;
  }
  tips_.push_back(std::make_unique<Tip>(Tip{&widget, text, {}, {}}));
  Tip& tip = *tips_.back();
  widget.signal_query_tooltip().connect(
      [this, &tip](int, int, bool, const Glib::RefPtr<Gtk::Tooltip>& tooltip) { return Query(tip, tooltip); },
      false);
  const auto motion = Gtk::EventControllerMotion::create();
  motion->signal_leave().connect([&tip] {
    tip.timer.disconnect();
    tip.clock.Leave();
  });
  widget.add_controller(motion);
}

void Tips::Adopt(Gtk::Widget& root) {
  if (const Glib::ustring text = root.get_tooltip_text(); !text.empty()) {
    root.set_tooltip_text("");
    Set(root, text);
  }
  for (Gtk::Widget* child = root.get_first_child(); child != nullptr; child = child->get_next_sibling())
    Adopt(*child);
}

bool Tips::Query(Tip& tip, const Glib::RefPtr<Gtk::Tooltip>& tooltip) {
  const double now = since_start_.Seconds();
  if (!tip.clock.Ask(now)) return false;
  tooltip->set_text(tip.text);
  if (!tip.timer.connected()) {
    tip.timer = Glib::signal_timeout().connect(
        [&tip] {
          tip.clock.End();
          tip.widget->trigger_tooltip_query();
          return false;
        },
        static_cast<unsigned>(1000 * TipClock::kLongest));
  }
  return true;
}

void Tips::End() {
  for (const auto& tip : tips_) {
    // GTK asks a widget for its tip when told to look again, wherever the pointer is: leave the others alone
    if (!tip->timer.connected()) continue;
    tip->timer.disconnect();
    tip->clock.End();
    tip->widget->trigger_tooltip_query();
  }
}

}  // namespace trocar::gui
