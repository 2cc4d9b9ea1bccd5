// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/hand_buttons.h"

#include <algorithm>

#include "trocar/base/assert.h"

namespace trocar::device {
namespace {

constexpr std::array<std::string_view, kActCount> kNames = {
    "none",      "cut",           "coagulate", "rinse",  "aspirate",
    "next_tool", "previous_tool", "assistant", "clutch", "freeze"};

}  // namespace

std::string_view ActName(HandAct act) noexcept {
  return act < HandAct::kCount ? kNames[static_cast<std::size_t>(act)] : kNames[0];
}

std::optional<HandAct> FindAct(std::string_view name) noexcept {
  const auto* const found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<HandAct>(found - kNames.begin());
}

ButtonMap DefaultButtons() noexcept {
  ButtonMap map{};
  for (auto& hand : map) {
    hand[0] = HandAct::kCut;
    hand[1] = HandAct::kCoagulate;
    hand[2] = HandAct::kPreviousTool;
    hand[3] = HandAct::kNextTool;
    hand[4] = HandAct::kClutch;
    hand[5] = HandAct::kFreeze;
  }
  return map;
}

HandButtons::HandButtons(const ButtonMap& map) noexcept : map_(map) {}

/// \return true if the press began
bool HandButtons::SeeButton(Button& button, HandAct act, bool is_down, double now, HandActs& acts) noexcept {
  if (!is_down) {
    if (button.is_pressed) button.released = now;
    button.is_down = button.is_pressed = button.is_stale = false;
    return false;
  }
  if (!button.is_down) button.since = now;
  button.is_down = true;
  if (button.is_stale || button.is_pressed || now - button.since < kDebounce) return false;
  button.is_pressed = true;
  const bool is_same_press = button.since - button.released < kDebounce;
  if (is_same_press) return false;
  ++acts.presses[static_cast<std::size_t>(act)];
  return true;
}

bool HandButtons::See(std::size_t hand, bool is_seen, std::uint32_t buttons, double now) noexcept {
  TROCAR_ASSERT(hand < kButtonHands);
  HandActs& acts = acts_[hand];
  const auto held_before = acts.is_held;
  acts.is_held = {};
  bool is_new = false;
  for (std::size_t i = 0; i < kMostButtons; ++i) {
    Button& button = buttons_[hand][i];
    if (!is_seen) {
      button = {};
      continue;
    }
    const HandAct act = map_[hand][i];
    is_new = SeeButton(button, act, (buttons >> i & 1u) != 0, now, acts) || is_new;
    if (button.is_pressed) acts.is_held[static_cast<std::size_t>(act)] = true;
  }
  acts.is_held[static_cast<std::size_t>(HandAct::kNone)] = false;
  return is_new || acts.is_held != held_before;
}

bool HandButtons::See(std::span<const HandSample> samples, double now) noexcept {
  bool is_new = false;
  for (std::size_t hand = 0; hand < kButtonHands && hand < samples.size(); ++hand)
    is_new = See(hand, samples[hand].is_valid, samples[hand].buttons, now) || is_new;
  return is_new;
}

void HandButtons::ReleaseAll() noexcept {
  for (std::size_t hand = 0; hand < kButtonHands; ++hand) See(hand, false, 0, 0.0);
}

}  // namespace trocar::device
