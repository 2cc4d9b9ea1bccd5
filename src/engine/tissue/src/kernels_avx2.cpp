// SPDX-License-Identifier: Apache-2.0
/// \file kernels_avx2.cpp  The inner loops, compiled with AVX2.
#if defined(__x86_64__)
#define TROCAR_LANES 8
#include "kernel_level.h"

namespace trocar::tissue {

const Kernels& GetKernelsAvx2() noexcept {
  return kKernels;
}

}  // namespace trocar::tissue
#endif
