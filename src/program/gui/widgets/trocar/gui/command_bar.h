// SPDX-License-Identifier: Apache-2.0
/// \file command_bar.h  A header bar whose buttons come from a window's table of commands.
#pragma once

#include <gtkmm.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "trocar/gui/command.h"
#include "trocar/gui/tips.h"
#include "trocar/host/translate.h"

namespace trocar::gui {

template <typename Action, typename Needs>
class CommandBar : public Gtk::HeaderBar {
 public:
  using Row = Command<Action, Needs>;

  /// \param commands  outlives the bar
  /// \param act       called when a person presses a button
  CommandBar(std::span<const Row> commands, Tips& tips, std::function<void(const Row&)> act)
      : tips_(tips), act_(std::move(act)) {
    Gtk::Box* linked = nullptr;
    for (const Row& row : commands) {
      if (row.button.side != ButtonSide::kStart) continue;
      Gtk::Button& button = Make(row);
      if (!row.button.is_linked) {
        linked = nullptr;
        pack_start(button);
        continue;
      }
      if (linked == nullptr) {
        linked = Gtk::make_managed<Gtk::Box>();
        linked->add_css_class("linked");
        pack_start(*linked);
      }
      linked->append(button);
    }
    // what is packed first at the end stands outermost
    for (auto row = commands.rbegin(); row != commands.rend(); ++row) {
      if (row->button.side == ButtonSide::kEnd) pack_end(Make(*row));
    }
    set_show_title_buttons(true);
    heading_.add_css_class("title");
    heading_.set_ellipsize(Pango::EllipsizeMode::END);
    set_title_widget(heading_);
  }

  /// The window's title between the buttons, without the program's name that stands before it for the desktop: where buttons are
  /// wide little room is left.
  /// \param title  "Trocar: peg transfer"
  void SetHeading(const std::string& title) {
    const std::size_t end = title.find(": ");
    heading_.set_text(end == std::string::npos ? title : title.substr(end + 2));
    tips_.Set(heading_, title);
  }

  /// \param state_of  how a command's button looks now
  void Show(const std::function<ButtonState(const Row&)>& state_of) {
    is_showing_ = true;
    for (const Entry& entry : entries_) {
      const ButtonState state = state_of(*entry.row);
      entry.button->set_visible(state.is_shown);
      entry.button->set_sensitive(state.is_enabled);
      const std::string label = host::Translate(state.label);
      if (entry.button->get_label().raw() != label) entry.button->set_label(label);
      if (entry.toggle != nullptr) entry.toggle->set_active(state.is_checked);
      tips_.Set(*entry.button, state.tip);
    }
    is_showing_ = false;
  }

 private:
  struct Entry {
    const Row* row;
    Gtk::Button* button;
    Gtk::ToggleButton* toggle;  // the same, or null
  };

  Gtk::Button& Make(const Row& row) {
    const std::string label = host::Translate(row.button.label);
    auto* toggle = row.button.is_toggle ? Gtk::make_managed<Gtk::ToggleButton>(label) : nullptr;
    Gtk::Button* button = toggle != nullptr ? toggle : Gtk::make_managed<Gtk::Button>(label);
    button->set_focus_on_click(false);
    if (row.button.is_primary) button->add_css_class("primary");
    if (row.button.least_width > 0) button->set_size_request(row.button.least_width, -1);
    const auto press = [this, &row] {
      if (!is_showing_) act_(row);
    };
    toggle != nullptr ? toggle->signal_toggled().connect(press) : button->signal_clicked().connect(press);
    entries_.push_back({&row, button, toggle});
    return *button;
  }

  Tips& tips_;
  Gtk::Label heading_;
  std::function<void(const Row&)> act_;
  std::vector<Entry> entries_;
  bool is_showing_ = false;  // buttons are being set by us
};

}  // namespace trocar::gui
