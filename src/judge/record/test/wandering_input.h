// SPDX-License-Identifier: Apache-2.0
/// \file wandering_input.h  Hands that wander without a script: the input of a tick depends on its number alone.
#pragma once

#include <cmath>
#include <cstdint>

#include "trocar/record/input_codec.h"

namespace trocar::record {

/// \param home  of the scene
inline scene::Input MakeWanderingInput(const scene::Input& home, std::uint64_t tick) {
  scene::Input input = home;
  const double t = static_cast<double>(tick) / 120;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const double phase = t + 2 * hand;
    // a hand's noise in the last digits
    const double noise = 1e-5 * std::sin(1e4 * phase * phase);
    input.hands[hand].pan += 0.05 * std::sin(1.3 * phase) + noise;
    input.hands[hand].tilt += 0.05 * std::sin(0.7 * phase) - noise;
    input.hands[hand].depth += 0.01 * std::sin(2.1 * phase);
    input.hands[hand].spin += 0.2 * std::sin(phase);
    input.hands[hand].jaw = 0.3 + 0.3 * std::sin(3 * phase);
    input.controls[hand].cut = tick / 90 % 5 == 2;
  }
  input.settings.head_up = tick > 300 ? 0.1 : 0.0;
  RoundJoints(input);
  return input;
}

}  // namespace trocar::record
