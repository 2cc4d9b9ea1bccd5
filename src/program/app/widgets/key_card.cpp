// SPDX-License-Identifier: Apache-2.0
#include "key_card.h"

#include <utility>
#include <vector>

#include "trocar/gui/card.h"
#include "trocar/gui/labels.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kListWidth = 660, kKeyWidth = 130;  // [pixels]
constexpr std::array<const char*, presenter::kButtonActs.size()> kActTexts = {
    host::Mark("close the jaws, hold the button"), host::Mark("open the jaws, hold the button"),
    host::Mark("look round, hold the button")};

}  // namespace

KeyCard::KeyCard(KeyCardServices services) : gui::ListCard(kListWidth), services_(std::move(services)) {
  restore_.set_tooltip_text(
      host::Translate("All keys and buttons as they were at first; Undo takes that back"));
  restore_.signal_clicked().connect([this] { services_.restore(); });
  undo_.set_tooltip_text(host::Translate("Takes back the last change of a key or button"));
  undo_.signal_clicked().connect([this] { services_.undo(); });
  AddFoot({&restore_, &undo_});
  MakeRows();
}

void KeyCard::MakeRows() {
  AddTitle(host::Translate("Mouse"));
  for (const presenter::ButtonAct act : presenter::kButtonActs) AddButton(act);
  AddTitle(host::Translate("Keys: press a button here, then the new key. Esc keeps the old one."));
  for (const presenter::SimulatorCommand& command : presenter::SimulatorCommands()) {
    if (presenter::KeyBindings::CanChange(command)) AddCommand(command);
  }
}

void KeyCard::AddButton(presenter::ButtonAct act) {
  auto* choice = Gtk::make_managed<Gtk::DropDown>();
  choice->set_model(Gtk::StringList::create(
      {host::Translate("left button"), host::Translate("middle button"), host::Translate("right button")}));
  const auto index = static_cast<std::size_t>(act);
  gui::SetAccessibleName(*choice, host::Translate(kActTexts[index]));
  choice->property_selected().signal_changed().connect([this, act, choice] {
    if (!is_showing_)
      services_.change_button(act, static_cast<presenter::MouseButton>(choice->get_selected() + 1));
  });
  buttons_[index] = choice;
  AddRow(host::Translate(kActTexts[index]), "", {choice});
}

void KeyCard::AddCommand(const presenter::SimulatorCommand& command) {
  Row row;
  row.conflict = gui::MakeLabel("", "conflict");
  row.button = Gtk::make_managed<Gtk::Button>();
  row.button->set_size_request(kKeyWidth, -1);
  row.button->signal_clicked().connect([this, &command] { AskFor(command); });
  rows_of_[command.id] = row;
  AddRow(presenter::DescribeCommand(command), "", {row.conflict, row.button});
}

void KeyCard::AskFor(const presenter::SimulatorCommand& command) {
  asked_ = command.id;
  rows_of_[asked_].button->set_label(host::Translate("Press a key …"));
  services_.ask_key([this, id = asked_](std::uint32_t key) {
    asked_.clear();
    if (key == 0 || !services_.change_key(id, key).ok()) {
      for (const presenter::SimulatorCommand& one : presenter::SimulatorCommands()) {
        if (id == one.id) rows_of_[id].button->set_label(gui::KeyText({shown_.KeyOf(one)}));
      }
    }
  });
}

void KeyCard::Show(const presenter::KeyBindings& bindings, bool can_undo) {
  shown_ = bindings;
  is_showing_ = true;
  for (const presenter::ButtonAct act : presenter::kButtonActs) {
    buttons_[static_cast<std::size_t>(act)]->set_selected(static_cast<guint>(bindings.ButtonOf(act)) - 1);
  }
  is_showing_ = false;
  for (const presenter::SimulatorCommand& command : presenter::SimulatorCommands()) {
    const auto found = rows_of_.find(command.id);
    if (found == rows_of_.end() || asked_ == command.id) continue;
    const std::string text = gui::KeyText({bindings.KeyOf(command)});
    const Row& row = found->second;
    if (row.button->get_label().raw() != text) row.button->set_label(text);
    gui::SetAccessibleName(*row.button, presenter::DescribeCommand(command) + ": " + text);
    const std::string conflict = bindings.ConflictOf(command);
    gui::SetTextOrHide(*row.conflict, conflict.empty() ? "" : "\u26a0 " + conflict);
  }
  undo_.set_sensitive(can_undo);
}

}  // namespace trocar::app
