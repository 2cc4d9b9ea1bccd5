// SPDX-License-Identifier: Apache-2.0
/// \file kernels_avx512.cpp  The inner loops, compiled with AVX-512.
#if defined(__x86_64__)
#define TROCAR_LANES 16
#include "kernel_level.h"

namespace trocar::tissue {

const Kernels& GetKernelsAvx512() noexcept {
  return kKernels;
}

}  // namespace trocar::tissue
#endif
