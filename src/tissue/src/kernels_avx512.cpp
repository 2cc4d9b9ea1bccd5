// SPDX-License-Identifier: Apache-2.0
/// \file kernels_avx512.cpp  The inner loops, compiled with AVX-512.
#if defined(__x86_64__)
#define TROCAR_LANES 16
#include "kernel_balance.h"
#include "kernel_bodies.h"
#include "kernel_table.h"
#include "kernel_vectors.h"

namespace trocar::tissue {

const Kernels& GetKernelsAvx512() noexcept {
  static constexpr Kernels kKernels = {MultiplyLinks,
                                       StepSlices,
                                       true,
                                       StepRows,
                                       CalcBalance,
                                       InvertBlocks,
                                       {CalcDot, FindLargest2, Advance, AddScaled, ScaleAndAdd}};
  return kKernels;
}

}  // namespace trocar::tissue
#endif
