// SPDX-License-Identifier: Apache-2.0
#include "wide_kernels.h"

#include "trocar/base/assert.h"

namespace trocar::collision {

const WideKernels& GetWideKernels(base::SimdLevel level) noexcept {
  TROCAR_ASSERT(base::HasSimdLevel(level));
#if defined(__x86_64__)
  if (level == base::SimdLevel::kAvx512) return GetWideKernelsAvx512();
  if (level == base::SimdLevel::kAvx2) return GetWideKernelsAvx2();
#endif
  return GetWideKernelsBaseline();
}

}  // namespace trocar::collision
