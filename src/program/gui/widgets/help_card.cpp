// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/help_card.h"

#include <string_view>

#include "trocar/host/translate.h"

namespace trocar::gui {

HelpCard::HelpCard(const std::vector<KeyHelp>& rows) {
  add_css_class("help");
  set_halign(Gtk::Align::CENTER);
  set_valign(Gtk::Align::CENTER);
  auto* grid = Gtk::make_managed<Gtk::Grid>();
  grid->set_column_spacing(24);
  grid->set_row_spacing(3);
  std::string_view group;
  int row = 0;
  for (const KeyHelp& help : rows) {
    if (help.group != group) {
      group = help.group;
      auto* title = Gtk::make_managed<Gtk::Label>(host::Translate(help.group));
      title->add_css_class("card-title");
      title->set_halign(Gtk::Align::START);
      grid->attach(*title, 0, row++, 2, 1);
    }
    auto* keys = Gtk::make_managed<Gtk::Label>(help.keys);
    keys->add_css_class("key");
    keys->set_halign(Gtk::Align::START);
    auto* meaning = Gtk::make_managed<Gtk::Label>(help.meaning);
    meaning->add_css_class("meaning");
    meaning->set_halign(Gtk::Align::START);
    grid->attach(*keys, 0, row);
    grid->attach(*meaning, 1, row++);
  }
  append(*grid);
}

}  // namespace trocar::gui
