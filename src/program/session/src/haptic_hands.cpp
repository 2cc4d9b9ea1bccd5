// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/haptic_loop.h"

namespace trocar::session {

const HapticHands* HapticHandsReader::Take(HapticLink& link) noexcept {
  if (!link.is_used.load(std::memory_order_relaxed)) return nullptr;
  silent_ticks_ = link.hands.Update() ? 0 : silent_ticks_ + 1;
  hands_ = link.hands.Front();
  if (silent_ticks_ > kLongestSilence) {
    for (device::HandActs& acts : hands_.acts) acts.is_held = {};
  }
  return &hands_;
}

}  // namespace trocar::session
