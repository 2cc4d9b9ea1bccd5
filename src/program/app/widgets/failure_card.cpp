// SPDX-License-Identifier: Apache-2.0
#include "failure_card.h"

#include <string>

#include "trocar/host/translate.h"

namespace trocar::app {

FailureCard::FailureCard() : Gtk::Box(Gtk::Orientation::VERTICAL) {
  add_css_class("failure");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  set_spacing(8);
  set_visible(false);
}

void FailureCard::Show(const base::Error& error) {
  if (get_visible()) return;
  const auto line = [this](const std::string& text, const char* style) {
    auto* label = Gtk::make_managed<Gtk::Label>(text);
    label->add_css_class(style);
    label->set_wrap(true);
    label->set_max_width_chars(64);
    label->set_selectable(true);
    label->set_focusable(false);
    label->set_xalign(0);
    append(*label);
  };
  line(std::string(base::CodeText(error.code)), "code");
  if (const std::string meaning = host::TranslatedMeaning(error.code); !meaning.empty())
    line(meaning, "text");
  line(host::TranslateComposed(error.message), "text");
  line(host::Translate("`trocar doctor` checks graphics, display and data and says how to mend them."),
       "text");
  set_visible(true);
}

}  // namespace trocar::app
