// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/key_bindings.h"

#include <algorithm>
#include <utility>

#include "trocar/host/translate.h"

namespace trocar::presenter {
namespace {

namespace key = gui::key;

struct NamedKey {
  std::uint32_t key;
  std::string_view name;
};
constexpr std::uint32_t kF2 = 0xffbf, kF12 = 0xffc9;  // X11 key symbols
constexpr NamedKey kNamed[] = {{' ', "Space"},
                               {key::kBackSpace, "Backspace"},
                               {key::kTab, "Tab"},
                               {key::kReturn, "Enter"},
                               {key::kHome, "Home"},
                               {key::kLeft, "Left"},
                               {key::kUp, "Up"},
                               {key::kRight, "Right"},
                               {key::kDown, "Down"},
                               {key::kPageUp, "Page Up"},
                               {key::kPageDown, "Page Down"},
                               {key::kEnd, "End"},
                               {key::kInsert, "Insert"},
                               {key::kDelete, "Delete"}};

std::uint32_t Lower(std::uint32_t key) {
  return key >= 'A' && key <= 'Z' ? key - 'A' + 'a' : key;
}

const SimulatorCommand* FindById(std::string_view id) {
  for (const SimulatorCommand& command : SimulatorCommands()) {
    if (id == command.id) return &command;
  }
  return nullptr;
}

std::optional<MouseButton> FindButton(std::string_view name) {
  for (const MouseButton button : {MouseButton::kLeft, MouseButton::kMiddle, MouseButton::kRight}) {
    if (NameOf(button) == name) return button;
  }
  return std::nullopt;
}

std::optional<ButtonAct> FindAct(std::string_view name) {
  for (const ButtonAct act : kButtonActs) {
    if (NameOf(act) == name) return act;
  }
  return std::nullopt;
}

}  // namespace

std::string_view NameOf(MouseButton button) noexcept {
  return button == MouseButton::kLeft ? "left" : button == MouseButton::kMiddle ? "middle" : "right";
}

std::string_view NameOf(ButtonAct act) noexcept {
  return act == ButtonAct::kCloseJaws ? "close" : act == ButtonAct::kOpenJaws ? "open" : "look";
}

std::optional<std::string> FindKeyName(std::uint32_t key) {
  for (const NamedKey& one : kNamed) {
    if (one.key == key) return std::string(one.name);
  }
  if (key >= kF2 && key <= kF12) return "F" + std::to_string(key - kF2 + 2);
  if (key > ' ' && key < 0x7f) return std::string(1, static_cast<char>(Lower(key)));
  return std::nullopt;
}

std::optional<std::uint32_t> FindNamedKey(std::string_view name) {
  for (const NamedKey& one : kNamed) {
    if (one.name == name) return one.key;
  }
  for (std::uint32_t f = kF2; f <= kF12; ++f) {
    if (FindKeyName(f) == name) return f;
  }
  if (name.size() == 1 && name[0] > ' ' && name[0] < 0x7f) return Lower(static_cast<std::uint32_t>(name[0]));
  return std::nullopt;
}

std::string DescribeCommand(const SimulatorCommand& command) {
  const std::string meaning = command.help.meaning;
  if (!meaning.empty()) return host::Translate(meaning);
  std::string id = command.id;
  std::replace(id.begin(), id.end(), '-', ' ');
  id = host::Translate(id);
  return command.action.action == Action::kMove ? host::TranslateWith("tip or spin: {1}", {id}) : id;
}

bool KeyBindings::CanChange(const SimulatorCommand& command) noexcept {
  const gui::KeyStroke& stroke = command.keys[0];
  return stroke.key != 0 && !stroke.control && !stroke.shift &&
         command.action.action != Action::kReleasePointer;
}

std::vector<std::string> KeyBindings::Use(const Own& own) {
  own_.clear();
  own_buttons_.clear();
  std::vector<std::string> refused;
  for (const auto& [id, name] : own.keys) {
    const auto found = FindNamedKey(name);
    if (!found || !SetKey(id, *found).ok())
      refused.push_back(host::TranslateWith("the key \"{1}\" of \"{2}\"", {name, id}));
  }
  for (const auto& [name, button_name] : own.buttons) {
    const auto act = FindAct(name);
    const auto button = FindButton(button_name);
    if (act && button) {
      own_buttons_[*act] = *button;
    } else {
      refused.push_back(host::TranslateWith("the button \"{1}\" of \"{2}\"", {button_name, name}));
    }
  }
  // three buttons for three acts, or none of it
  std::array<int, 4> uses{};
  for (const ButtonAct act : kButtonActs) ++uses[static_cast<std::size_t>(ButtonOf(act))];
  if (std::any_of(uses.begin(), uses.end(), [](int count) { return count > 1; })) {
    own_buttons_.clear();
    refused.emplace_back(host::Translate("mouse buttons of which one has two acts"));
  }
  return refused;
}

KeyBindings::Own KeyBindings::GetOwn() const {
  Own own;
  for (const auto& [id, key] : own_) own.keys[id] = FindKeyName(key).value_or("");
  for (const auto& [act, button] : own_buttons_) own.buttons[std::string(NameOf(act))] = NameOf(button);
  return own;
}

base::Status KeyBindings::SetKey(const std::string& id, std::uint32_t key) {
  const SimulatorCommand* command = FindById(id);
  if (command == nullptr || !CanChange(*command))
    return base::Error{base::ErrorCode::kUsage, "\"" + id + "\" is no command whose key can be changed"};
  if (!FindKeyName(key))
    return base::Error{base::ErrorCode::kUsage,
                       "this key cannot be used: take a letter, a digit, an arrow or F2 to F12"};
  own_[id] = Lower(key);
  return {};
}

void KeyBindings::SetButton(ButtonAct act, MouseButton button) {
  const auto other = ActOf(button);
  const MouseButton former = ButtonOf(act);
  if (other && *other != act) own_buttons_[*other] = former;
  own_buttons_[act] = button;
}

void KeyBindings::RestoreAll() {
  own_.clear();
  own_buttons_.clear();
}

std::uint32_t KeyBindings::KeyOf(const SimulatorCommand& command) const {
  if (const auto own = own_.find(command.id); own != own_.end()) return own->second;
  return command.keys[0].control ? 0 : MirrorKey(command.keys[0].key, layout_);
}

std::array<gui::KeyStroke, 2> KeyBindings::StrokesOf(const SimulatorCommand& command) const {
  std::array<gui::KeyStroke, 2> strokes = command.keys;
  for (gui::KeyStroke& stroke : strokes) {
    if (!stroke.control) stroke.key = MirrorKey(stroke.key, layout_);
  }
  if (const auto own = own_.find(command.id); own != own_.end()) strokes[0] = {own->second};
  return strokes;
}

MouseButton KeyBindings::ButtonOf(ButtonAct act) const {
  if (const auto own = own_buttons_.find(act); own != own_buttons_.end()) return own->second;
  if (act == ButtonAct::kLook) return MouseButton::kMiddle;
  const bool is_mirrored = layout_ == KeyLayout::kLeftHanded;
  return (act == ButtonAct::kCloseJaws) != is_mirrored ? MouseButton::kLeft : MouseButton::kRight;
}

std::optional<ButtonAct> KeyBindings::ActOf(MouseButton button) const {
  for (const ButtonAct act : kButtonActs) {
    if (ButtonOf(act) == button) return act;
  }
  return std::nullopt;
}

KeyMeaning KeyBindings::Find(std::uint32_t key, bool control) const {
  if (control) return FindKeyMeaning(key, true);
  key = Lower(key);
  for (const auto& [id, own] : own_) {
    if (own == key) return FindById(id)->action;
  }
  const std::uint32_t mirrored = MirrorKey(key, layout_);
  const SimulatorCommand* command = FindCommand(SimulatorCommands(), mirrored, false, false);
  if (command == nullptr) return {};
  // its own key has taken the place of this one
  const bool is_replaced = own_.contains(command->id) && command->keys[0].key == mirrored;
  return is_replaced ? KeyMeaning{} : command->action;
}

std::string KeyBindings::ConflictOf(const SimulatorCommand& command) const {
  if (!CanChange(command)) return {};
  const std::uint32_t key = KeyOf(command);
  std::string others;
  for (const SimulatorCommand& other : SimulatorCommands()) {
    if (!CanChange(other) || std::string_view(other.id) == command.id || KeyOf(other) != key) continue;
    others += (others.empty() ? "" : "; ") + DescribeCommand(other);
  }
  if (others.empty()) return {};
  const bool works = Find(key, false) == command.action;
  return (works ? host::Translate("The same key as: ") : host::Translate("Without a key now, which does: ")) +
         others;
}

std::string KeyBindings::Fill(std::string_view text) const {
  std::string filled;
  while (!text.empty()) {
    const std::size_t open = text.find('{');
    filled += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find('}', open);
    const std::string_view name = text.substr(open + 1, close - open - 1);
    constexpr std::string_view kButton = "button:";
    if (name.starts_with(kButton)) {
      const auto act = FindAct(name.substr(kButton.size()));
      filled += act ? host::TranslateIn("mouse button", NameOf(ButtonOf(*act))) : std::string(name);
    } else if (const SimulatorCommand* command = FindById(name)) {
      filled += gui::KeyText(StrokesOf(*command)[0]);
    } else {
      filled += name;
    }
    if (close == std::string_view::npos) break;
    text.remove_prefix(close + 1);
  }
  return filled;
}

std::vector<gui::KeyHelp> KeyBindings::Help() const {
  constexpr const char* kGroups[] = {"Instruments", "Operation", "Laparoscope", "Simulation", "View"};
  std::vector<SimulatorCommand> commands(SimulatorCommands().begin(), SimulatorCommands().end());
  const std::string closing = Fill(host::Translate("{button:close} button")),
                    opening = Fill(host::Translate("{button:open} button")),
                    looking = Fill(host::Translate("{button:look} button"));
  const auto capital = [](std::string text) {
    if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
    return text;
  };
  const std::string close = capital(closing), open = capital(opening), look = capital(looking);
  for (SimulatorCommand& command : commands) {
    command.keys = StrokesOf(command);
    const std::string_view gesture = command.help.gesture;
    if (gesture == "Left button") command.help.gesture = close.c_str();
    if (gesture == "Right button") command.help.gesture = open.c_str();
    if (gesture == "Middle button") command.help.gesture = look.c_str();
  }
  return MakeKeyHelp(std::span<const SimulatorCommand>(commands), kGroups);
}

}  // namespace trocar::presenter
