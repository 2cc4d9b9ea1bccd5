// SPDX-License-Identifier: Apache-2.0
/// \file command.h  Commands of a window, one row a command: its keys, its button, when it is possible, and what the
/// help page says. Keys, header bar and help page are made from this table and cannot disagree.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace trocar::gui {

// X11 key symbols (X11/keysymdef.h); letters and digits are their ASCII code, in lower case
namespace key {
inline constexpr std::uint32_t kBackSpace = 0xff08, kTab = 0xff09, kReturn = 0xff0d, kEscape = 0xff1b,
                               kIsoLeftTab = 0xfe20, kHome = 0xff50, kLeft = 0xff51, kUp = 0xff52,
                               kRight = 0xff53, kDown = 0xff54, kPageUp = 0xff55, kPageDown = 0xff56,
                               kEnd = 0xff57, kInsert = 0xff63, kPadEnter = 0xff8d, kPadPlus = 0xffab,
                               kPadMinus = 0xffad, kPad1 = 0xffb1, kPad2 = 0xffb2, kF1 = 0xffbe, kF6 = 0xffc3,
                               kF11 = 0xffc8, kDelete = 0xffff;
}  // namespace key

struct KeyStroke {
  std::uint32_t key = 0;  ///< 0: none
  bool control = false, shift = false;

  friend bool operator==(const KeyStroke&, const KeyStroke&) = default;
};

constexpr KeyStroke Ctrl(std::uint32_t key) {
  return {key, true, false};
}
constexpr KeyStroke Shift(std::uint32_t key) {
  return {key, false, true};
}
constexpr KeyStroke CtrlShift(std::uint32_t key) {
  return {key, true, true};
}

/// "Ctrl+Shift+Z", "Page Up", "Comma".
std::string KeyText(const KeyStroke& stroke);

/// Entry of a command on the help page.
struct CommandHelp {
  const char* group = "";    ///< begins a row of this group; empty: goes on with the row before
  const char* gesture = "";  ///< what the mouse does in place of a key
  const char* meaning = "";
};

enum class ButtonSide { kNone, kStart, kEnd };

/// A button of the header bar.
struct CommandButton {
  ButtonSide side = ButtonSide::kNone;
  const char* label = "";
  const char* tip = "";
  bool is_toggle = false, is_primary = false;
  int least_width = 0;  ///< holds each of its labels [pixels]
};

/// How a button looks now; the window's presenter says it.
struct ButtonState {
  bool is_shown = true, is_enabled = true, is_checked = false;
  std::string label, tip;
};

/// \tparam Action  what is done; == compares
/// \tparam Needs   what must be the case, judged by the window's presenter
template <typename Action, typename Needs>
struct Command {
  const char* id = "";  ///< stable: "reset"
  Action action{};
  Needs needs{};
  std::array<KeyStroke, 2> keys{};  ///< that the help page names
  std::array<KeyStroke, 2> also{};  ///< that do the same
  CommandHelp help{};
  CommandButton button{};
  bool works_everywhere = false;  ///< by its keys, while another part of the window has the keyboard, too
};

/// One line of the help.
struct KeyHelp {
  std::string group, keys, meaning;
};

/// Puts a row's parts after what it has: "1   2   Tab", "left hand, right hand, the other hand".
void AppendHelp(std::span<const KeyStroke> keys, const CommandHelp& help, std::vector<KeyHelp>& rows);

/// Rows of one group together, groups in the order given; rows of other groups are left out.
std::vector<KeyHelp> SortByGroup(std::vector<KeyHelp> rows, std::span<const char* const> groups);

/// The command of a key, or null.
/// \param key  X11 key symbol, as GDK gives it; letters in either case
template <typename Action, typename Needs>
const Command<Action, Needs>* FindCommand(std::span<const Command<Action, Needs>> commands, std::uint32_t key,
                                          bool control, bool shift) noexcept {
  if (key >= 'A' && key <= 'Z') key += 'a' - 'A';
  const KeyStroke wanted{key, control, shift};
  if (key == 0) return nullptr;
  for (const auto& command : commands) {
    for (const auto* strokes : {&command.keys, &command.also}) {
      for (const KeyStroke& stroke : *strokes) {
        if (stroke == wanted) return &command;
      }
    }
  }
  return nullptr;
}

/// The command that does it, or null.
template <typename Action, typename Needs>
const Command<Action, Needs>* FindCommand(std::span<const Command<Action, Needs>> commands,
                                          const Action& action) noexcept {
  for (const auto& command : commands) {
    if (command.action == action) return &command;
  }
  return nullptr;
}

/// Handler of a command in a window's presenter, one row an action: whoever looks for a command's effect finds it here.
template <typename Presenter, typename Action>
struct CommandHandler {
  Action action{};
  void (*run)(Presenter&) = nullptr;
  bool (*is_checked)(const Presenter&) = nullptr;  ///< of a toggle; null: never
};

/// The row of an action, or null where the presenter does nothing for it.
template <typename Presenter, typename Action>
const CommandHandler<Presenter, Action>* FindHandler(
    std::span<const CommandHandler<Presenter, Action>> handlers, const Action& action) noexcept {
  for (const auto& handler : handlers) {
    if (handler.action == action) return &handler;
  }
  return nullptr;
}

/// All rows of the help page.
/// \param groups  in the order of the page; rows within a group stand in the order of the table
template <typename Action, typename Needs>
std::vector<KeyHelp> MakeKeyHelp(std::span<const Command<Action, Needs>> commands,
                                 std::span<const char* const> groups) {
  std::vector<KeyHelp> rows;
  for (const auto& command : commands) AppendHelp(command.keys, command.help, rows);
  return SortByGroup(std::move(rows), groups);
}

/// Tooltip of a button: "Undo (Ctrl+Z)".
std::string TipText(const char* tip, std::span<const KeyStroke> keys);

}  // namespace trocar::gui
