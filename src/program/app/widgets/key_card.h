// SPDX-License-Identifier: Apache-2.0
/// \file key_card.h  Keys and mouse buttons, over the picture: what each does, how to change it, and which are in conflict.
#pragma once

#include <gtkmm.h>

#include <array>
#include <functional>
#include <map>
#include <string>

#include "trocar/gui/list_card.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/key_bindings.h"

namespace trocar::app {

/// Services that the card asks of the window.
struct KeyCardServices {
  /// The next key that is pressed is told to the function, and does nothing else; 0: Esc, none is wanted.
  std::function<void(std::function<void(std::uint32_t)>)> ask_key;
  std::function<base::Status(const std::string& id, std::uint32_t key)> change_key;
  std::function<void(presenter::ButtonAct, presenter::MouseButton)> change_button;
  std::function<void()> restore, undo;
};

class KeyCard : public gui::ListCard {
 public:
  explicit KeyCard(KeyCardServices services);

  void Show(const presenter::KeyBindings& bindings, bool can_undo);

 private:
  struct Row {
    Gtk::Button* button = nullptr;
    Gtk::Label* conflict = nullptr;
  };
  void MakeRows();
  void AddCommand(const presenter::SimulatorCommand& command);
  void AddButton(presenter::ButtonAct act);
  void AskFor(const presenter::SimulatorCommand& command);

  KeyCardServices services_;
  std::map<std::string, Row> rows_of_;  // by the command's id
  std::array<Gtk::DropDown*, presenter::kButtonActs.size()> buttons_{};
  std::string asked_;        // id of the command whose new key is waited for
  bool is_showing_ = false;  // the choice changes by the program, not by a person
  presenter::KeyBindings shown_;
  Gtk::Button restore_{host::Translate("As at first")}, undo_{host::Translate("Undo")};
};

}  // namespace trocar::app
