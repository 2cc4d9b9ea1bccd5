// SPDX-License-Identifier: Apache-2.0
#include "trocar/core/simd_level.h"

namespace trocar::core {

std::string_view SimdLevelName(SimdLevel level) noexcept {
  switch (level) {
    case SimdLevel::kBaseline:
      return "baseline";
    case SimdLevel::kAvx2:
      return "avx2";
    case SimdLevel::kAvx512:
      return "avx512";
  }
  return "";
}

bool HasSimdLevel(SimdLevel level) noexcept {
#if defined(__x86_64__)
  if (level == SimdLevel::kAvx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (level == SimdLevel::kAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  }
#endif
  return level == SimdLevel::kBaseline;
}

SimdLevel FindSimdLevel() noexcept {
  if (HasSimdLevel(SimdLevel::kAvx512)) return SimdLevel::kAvx512;
  return HasSimdLevel(SimdLevel::kAvx2) ? SimdLevel::kAvx2 : SimdLevel::kBaseline;
}

}  // namespace trocar::core
