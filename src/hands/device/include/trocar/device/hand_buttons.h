// SPDX-License-Identifier: Apache-2.0
/// \file hand_buttons.h  Buttons and pedals of a device and their acts: debounced, and let go of when the device is lost.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "trocar/device/hand_sample.h"

namespace trocar::device {

/// Act of a button, for the hand to which it belongs.
enum class HandAct : std::uint8_t {
  kNone,
  kCut,           ///< yellow pedal, while held
  kCoagulate,     ///< blue pedal, while held
  kRinse,         ///< while held
  kAspirate,      ///< while held
  kNextTool,      ///< of the hand's tray
  kPreviousTool,  ///< of the hand's tray
  kAssistant,     ///< the next command to the assistant
  kClutch,        ///< while held the tool stands still; then it goes on from there, wherever the hand is
  kFreeze,        ///< as kClutch, from one press to the next
  kCount
};
inline constexpr std::size_t kActCount = static_cast<std::size_t>(HandAct::kCount);
/// "none", "cut", "coagulate", "rinse", "aspirate", "next_tool", "previous_tool", "assistant", "clutch", "freeze"
std::string_view ActName(HandAct act) noexcept;
/// The act of that name; nothing for an unknown one.
std::optional<HandAct> FindAct(std::string_view name) noexcept;

/// Left and right hand.
inline constexpr std::size_t kButtonHands = 2;
/// Buttons of a hand that can have an act; more are ignored.
inline constexpr std::size_t kMostButtons = 16;
using ButtonMap = std::array<std::array<HandAct, kMostButtons>, kButtonHands>;
/// Cut, coagulate, previous tool, next tool, clutch, freeze: the same for both hands of every device.
ButtonMap DefaultButtons() noexcept;

/// State of a hand's acts at one time: which are held, and how often each was pressed.
struct HandActs {
  std::array<bool, kActCount> is_held{};
  std::array<std::uint32_t, kActCount>
      presses{};  ///< since the start; a press is never lost between two looks

  bool IsHeld(HandAct act) const noexcept { return is_held[static_cast<std::size_t>(act)]; }
  std::uint32_t CountPresses(HandAct act) const noexcept { return presses[static_cast<std::size_t>(act)]; }
  friend bool operator==(const HandActs&, const HandActs&) = default;
};

/// Buttons of two hands, from raw bits to acts.
///
/// A button counts as pressed once it has been down for kDebounce without a gap, and as let go at once; let go for less than
/// kDebounce, it goes on as the same press. What is down when a hand comes into sight, at the start or after a loss, does
/// nothing before it has been let go.
/// \note Real-time safe: no allocation, lock or throw.
class HandButtons {
 public:
  static constexpr double kDebounce = 0.015;  // [s]

  explicit HandButtons(const ButtonMap& map = DefaultButtons()) noexcept;

  /// Looks at one hand.
  ///
  /// \param is_seen  false lets go of everything
  /// \param buttons  bit n is button n + 1, set while it is down
  /// \param now      [s], not falling
  /// \return true if the hand's acts changed
  bool See(std::size_t hand, bool is_seen, std::uint32_t buttons, double now) noexcept;
  /// See() for the left and right hand of a driver's samples.
  bool See(std::span<const HandSample> samples, double now) noexcept;
  /// The device is lost: every pedal is up, at once. Presses stay counted.
  void ReleaseAll() noexcept;

  const std::array<HandActs, kButtonHands>& Acts() const noexcept { return acts_; }

 private:
  struct Button {
    bool is_down = false;
    bool is_pressed = false;  // down for long enough
    bool is_stale = true;     // down before anybody looked
    double since = -1e9;      // it changed [s]
    double released = -1e9;   // end of the last press [s]
  };
  bool SeeButton(Button& button, HandAct act, bool is_down, double now, HandActs& acts) noexcept;

  ButtonMap map_;
  std::array<std::array<Button, kMostButtons>, kButtonHands> buttons_;
  std::array<HandActs, kButtonHands> acts_;
};

}  // namespace trocar::device
