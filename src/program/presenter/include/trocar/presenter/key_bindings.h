// SPDX-License-Identifier: Apache-2.0
/// \file key_bindings.h  Which key and which mouse button does what: the table's, the layout's, and what a person has set.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/presenter/simulator_commands.h"

namespace trocar::presenter {

/// As X11 and GDK number them.
enum class MouseButton : std::uint8_t { kLeft = 1, kMiddle = 2, kRight = 3 };
/// Function of a mouse button while it is held.
enum class ButtonAct : std::uint8_t { kCloseJaws, kOpenJaws, kLook };
inline constexpr std::array<ButtonAct, 3> kButtonActs = {ButtonAct::kCloseJaws, ButtonAct::kOpenJaws,
                                                         ButtonAct::kLook};

/// "left", "middle", "right"
std::string_view NameOf(MouseButton button) noexcept;
/// "close", "open", "look"
std::string_view NameOf(ButtonAct act) noexcept;

class KeyBindings {
 public:
  /// A person's own bindings, as they are stored.
  struct Own {
    std::map<std::string, std::string> keys;     ///< name of the key, by the command's id
    std::map<std::string, std::string> buttons;  ///< name of the button, by the act's
    friend bool operator==(const Own&, const Own&) = default;
  };

  void SetLayout(KeyLayout layout) { layout_ = layout; }
  KeyLayout Layout() const { return layout_; }

  /// Takes over what was kept. \return what cannot be used, in words
  std::vector<std::string> Use(const Own& own);
  Own GetOwn() const;

  /// Whether a command can have another key: it has one without Ctrl, and is not the one that frees the pointer.
  static bool CanChange(const SimulatorCommand& command) noexcept;
  /// \param key  X11 key symbol
  /// \return kUsage where the key cannot be used, or the command not changed
  base::Status SetKey(const std::string& id, std::uint32_t key);
  /// The button's former act gets the button that this act had.
  void SetButton(ButtonAct act, MouseButton button);
  void Restore(const std::string& id) { own_.erase(id); }
  void RestoreAll();
  bool IsOwn(const std::string& id) const { return own_.contains(id); }

  /// The key that does it now, without Ctrl; 0: none.
  std::uint32_t KeyOf(const SimulatorCommand& command) const;
  /// Keys as help and tips name them: the own one in place of the table's first.
  std::array<gui::KeyStroke, 2> StrokesOf(const SimulatorCommand& command) const;
  MouseButton ButtonOf(ButtonAct act) const;
  /// The act of a button.
  std::optional<ButtonAct> ActOf(MouseButton button) const;
  /// Meaning of a key in the picture; a key that somebody has set comes before the table's.
  KeyMeaning Find(std::uint32_t key, bool control) const;
  /// Commands that have the same key, in words; empty: none.
  std::string ConflictOf(const SimulatorCommand& command) const;

  /// Puts names of keys in the place of ids, and of buttons: "Hold {close-jaws} or the {button:close} button".
  std::string Fill(std::string_view text) const;
  /// All rows of the help page.
  std::vector<gui::KeyHelp> Help() const;

 private:
  KeyLayout layout_ = KeyLayout::kRightHanded;
  std::map<std::string, std::uint32_t> own_;  // key symbol, by the command's id
  std::map<ButtonAct, MouseButton> own_buttons_;
};

/// Name of a key that can be set: "m", "Page Up", "F7"; nothing of others.
std::optional<std::string> FindKeyName(std::uint32_t key);
std::optional<std::uint32_t> FindNamedKey(std::string_view name);
/// Description of a command for lists: "close the jaws (hold)".
std::string DescribeCommand(const SimulatorCommand& command);

}  // namespace trocar::presenter
