// SPDX-License-Identifier: Apache-2.0
/// \file simd_level.h  Which vector instructions the inner loops use.
#pragma once

#include <string_view>

namespace trocar::base {

/// Inner loops that are worth it exist once for each level, and give the same bits at each.
enum class SimdLevel {
  kBaseline,  ///< what every processor of the architecture has (x86-64: SSE2, 4 floats)
  kAvx2,      ///< 8 floats: AVX2
  kAvx512     ///< 16 floats: AVX-512 F, VL, DQ and BW (x86-64-v4)
};
/// "baseline", "avx2", "avx512"
std::string_view SimdLevelName(SimdLevel level) noexcept;

/// The level that TROCAR_SIMD names, else the widest that this processor and this build have (simd_choice.h).
SimdLevel FindSimdLevel() noexcept;
/// True where this processor and this build have `level`.
bool HasSimdLevel(SimdLevel level) noexcept;

}  // namespace trocar::base
