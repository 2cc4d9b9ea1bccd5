// SPDX-License-Identifier: Apache-2.0
/// \file engine_bits.h  Which programs compute the same states.
#pragma once

#include <cstdint>

namespace trocar::simulation {

/// Programs of one number compute the same states from the same scene and inputs, to the bit, on every processor and platform.
/// Whoever changes what a tick computes raises it. 1: results depended on the processor and on its C library (before 2026-11-29).
inline constexpr int kEngineBits = 2;

/// Coverage of a fingerprint of the model.
enum class ModelFingerprintKind : std::uint8_t {
  kFirst =
      1,  ///< tissue, ports, neighbours; how many objects and goals there are: recordings until 2026-11-29
  kEveryField = 2  ///< every field that decides a state, a picture or a verdict (scene/scene_fields.h)
};

}  // namespace trocar::simulation
