// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/haptic_loop.h"

namespace trocar::session {

void HapticHandsReader::Take(HapticLink& link, scene::Input& input) noexcept {
  if (!link.is_used.load(std::memory_order_relaxed)) return;
  silent_ticks_ = link.hands.Update() ? 0 : silent_ticks_ + 1;
  const HapticHands& hands = link.hands.Front();
  for (const instrument::Hand hand : {instrument::kLeft, instrument::kRight}) {
    if (hands.is_driven[hand]) input.hands[hand] = hands.joints[hand];
  }
  if (silent_ticks_ <= kLongestSilence) PressPedals(hands.acts, input);
}

}  // namespace trocar::session
