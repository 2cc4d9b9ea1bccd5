// SPDX-License-Identifier: Apache-2.0
/// \file command_bar.h  A header bar whose buttons come from a window's table of commands.
#pragma once

#include <gtkmm.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "trocar/gui/command.h"
#include "trocar/gui/fold_row.h"
#include "trocar/gui/tips.h"
#include "trocar/host/translate.h"

namespace trocar::gui {

/// Buttons that have no room wait behind one at the end of the line.
template <typename Action, typename Needs>
class CommandBar : public Gtk::WindowHandle {
 public:
  using Row = Command<Action, Needs>;

  /// \param commands  outlives the bar
  /// \param act       called when a person presses a button
  CommandBar(std::span<const Row> commands, Tips& tips, std::function<void(const Row&)> act)
      : tips_(tips), act_(std::move(act)) {
    // the end gives way first but for its last two, then the start from behind; the primary button stays
    int order = 1;
    std::map<const Row*, int> orders;
    std::vector<const Row*> start, end;
    for (const Row& row : commands) {
      if (row.button.side == ButtonSide::kStart) start.push_back(&row);
      if (row.button.side == ButtonSide::kEnd) end.push_back(&row);
    }
    for (std::size_t i = std::max<std::size_t>(end.size(), 2) - 2; i < end.size(); ++i)
      orders[end[i]] = order++;
    for (const Row* row : start) orders[row] = row->button.is_primary ? 0 : order++;
    for (std::size_t i = std::max<std::size_t>(end.size(), 2) - 2; i-- > 0;) orders[end[i]] = order++;
    for (const Row* row : start) line_.Append(Make(*row), orders[row]);
    heading_.add_css_class("title");
    line_.Append(heading_, FoldRow::kSpare);
    line_.BeginEnd();
    for (const Row* row : end) line_.Append(Make(*row), orders[row]);
    line_.SetMaker([this] { return MakeMore(); });
    add_css_class("commands");
    box_.append(line_);
    box_.append(controls_);
    set_child(box_);
  }

  /// Whether the bar also has what closes and hides the window.
  void SetShowTitleButtons(bool is_shown) { controls_.set_visible(is_shown); }

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

  /// What has no room in the line, one below the other.
  Gtk::Widget* MakeMore() {
    auto* list = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
    list->set_spacing(4);
    for (const Entry& entry : entries_) {
      if (!line_.IsFolded(*entry.button)) continue;
      const bool is_checked = entry.toggle != nullptr && entry.toggle->get_active();
      auto* button =
          Gtk::make_managed<Gtk::Button>((is_checked ? "\u2713 " : "") + entry.button->get_label());
      button->set_sensitive(entry.button->get_sensitive());
      button->signal_clicked().connect([this, row = entry.row] {
        line_.CloseMore();
        // the list goes with this button: after its handler
        Glib::signal_timeout().connect_once([this, row] { act_(*row); }, 0);
      });
      list->append(*button);
    }
    return list;
  }

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
  Gtk::Label heading_;  // outlives the line that holds it
  Gtk::Box box_;
  FoldRow line_;
  Gtk::WindowControls controls_{Gtk::PackType::END};
  std::function<void(const Row&)> act_;
  std::vector<Entry> entries_;
  bool is_showing_ = false;  // buttons are being set by us
};

}  // namespace trocar::gui
