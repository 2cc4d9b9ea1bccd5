// SPDX-License-Identifier: Apache-2.0
#include "kernels.h"

#include "kernel_table.h"
#include "trocar/core/assert.h"

namespace trocar::tissue {

const Kernels& GetKernels(SimdLevel level) noexcept {
  TROCAR_ASSERT(HasSimdLevel(level));
#if defined(__x86_64__)
  if (level == SimdLevel::kAvx512) return GetKernelsAvx512();
  if (level == SimdLevel::kAvx2) return GetKernelsAvx2();
#endif
  return GetKernelsBaseline();
}

}  // namespace trocar::tissue
