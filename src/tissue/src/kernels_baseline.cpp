// SPDX-License-Identifier: Apache-2.0
/// \file kernels_baseline.cpp  The inner loops, what every processor of the architecture has.
#define TROCAR_LANES 4
#include "kernel_balance.h"
#include "kernel_bodies.h"
#include "kernel_table.h"
#include "kernel_vectors.h"

namespace trocar::tissue {

const Kernels& GetKernelsBaseline() noexcept {
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
