// SPDX-License-Identifier: Apache-2.0
#include "kernels.h"

#include "kernel_table.h"
#include "trocar/base/assert.h"

namespace trocar::tissue {

const Kernels& GetKernels(base::SimdLevel level) noexcept {
  TROCAR_ASSERT(base::HasSimdLevel(level));
#if defined(__x86_64__)
  if (level == base::SimdLevel::kAvx512) return GetKernelsAvx512();
  if (level == base::SimdLevel::kAvx2) return GetKernelsAvx2();
#endif
  return GetKernelsBaseline();
}

}  // namespace trocar::tissue
