// SPDX-License-Identifier: Apache-2.0
/// \file simd_choice.h  Which of a processor's levels of vector instructions run: the widest, or the one that is asked for.
#pragma once

#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/simd_level.h"

namespace trocar::base {

/// Names the level that FindSimdLevel() gives, so that anybody can compare them.
inline constexpr const char* kSimdVariable = "TROCAR_SIMD";

/// The levels that this processor and this build have, from the baseline on.
std::vector<SimdLevel> ListSimdLevels();
/// The last of them.
SimdLevel FindWidestSimdLevel() noexcept;

/// \param named  "baseline" or "sse2", "avx2", "avx512"; empty: the widest
/// \return kUsage with those that there are, where it is none of them
Result<SimdLevel> ReadSimdLevel(std::string_view named);
/// For a program's start: the error where the environment names a level that is not there. FindSimdLevel() cannot say so, and
/// gives the widest.
Status CheckSimdLevel();

}  // namespace trocar::base
