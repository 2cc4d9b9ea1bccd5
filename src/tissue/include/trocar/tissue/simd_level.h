// SPDX-License-Identifier: Apache-2.0
/// \file simd_level.h  Which vector instructions the solvers' inner loops use.
#pragma once

#include <string_view>

namespace trocar::tissue {

/// The inner loops exist once for each level. None reorders or approximates, and each rounds a product and a
/// sum together only where it says so: one level's bits do not depend on compiler or optimisation. AVX2 and
/// AVX-512 give the same bits; the baseline has no fused multiply-add and differs in the last place.
enum class SimdLevel {
  kBaseline,  ///< what every processor of the architecture has (x86-64: SSE2, 4 floats)
  kAvx2,      ///< 8 floats: AVX2 and FMA
  kAvx512     ///< 16 floats: AVX-512 F, VL, DQ and BW (x86-64-v4)
};
/// "baseline", "avx2", "avx512"
std::string_view SimdLevelName(SimdLevel level) noexcept;

/// The widest level that this processor and this build have.
SimdLevel FindSimdLevel() noexcept;
/// True where this processor and this build have `level`.
bool HasSimdLevel(SimdLevel level) noexcept;

}  // namespace trocar::tissue
