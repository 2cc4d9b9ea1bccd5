// SPDX-License-Identifier: Apache-2.0
#include "kernels.h"

#include "kernel_table.h"
#include "trocar/core/assert.h"

namespace trocar::tissue {

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

const Kernels& GetKernels(SimdLevel level) noexcept {
  TROCAR_ASSERT(HasSimdLevel(level));
#if defined(__x86_64__)
  if (level == SimdLevel::kAvx512) return GetKernelsAvx512();
  if (level == SimdLevel::kAvx2) return GetKernelsAvx2();
#endif
  return GetKernelsBaseline();
}

}  // namespace trocar::tissue
