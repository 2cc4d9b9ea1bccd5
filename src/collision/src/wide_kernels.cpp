// SPDX-License-Identifier: Apache-2.0
#include "wide_kernels.h"

#include "trocar/core/assert.h"

namespace trocar::collision {

const WideKernels& GetWideKernels(core::SimdLevel level) noexcept {
  TROCAR_ASSERT(core::HasSimdLevel(level));
#if defined(__x86_64__)
  if (level == core::SimdLevel::kAvx512) return GetWideKernelsAvx512();
  if (level == core::SimdLevel::kAvx2) return GetWideKernelsAvx2();
#endif
  return GetWideKernelsBaseline();
}

}  // namespace trocar::collision
