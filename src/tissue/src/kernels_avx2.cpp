// SPDX-License-Identifier: Apache-2.0
/// \file kernels_avx2.cpp  The inner loops, compiled with AVX2.
#if defined(__x86_64__)
#define TROCAR_LANES 8
#include "kernel_balance.h"
#include "kernel_bodies.h"
#include "kernel_table.h"
#include "kernel_vectors.h"

namespace trocar::tissue {

const Kernels& GetKernelsAvx2() noexcept {
  static constexpr Kernels kKernels = {MultiplyLinks,
                                       StepSlices,
                                       false,
                                       StepRows,
                                       CalcBalance,
                                       InvertBlocks,
                                       {CalcDot, FindLargest2, Advance, AddScaled, ScaleAndAdd}};
  return kKernels;
}

}  // namespace trocar::tissue
#endif
