// SPDX-License-Identifier: Apache-2.0
/// \file wide_kernels_baseline.cpp  The loops over a WideTree, compiled for one level of vector instructions.
#include "wide_kernel_bodies.h"

namespace trocar::collision {

const WideKernels& GetWideKernelsBaseline() noexcept {
  static constexpr WideKernels kKernels = {ConvertPoints, RefitNodes, SearchPoint, SearchSegment};
  return kKernels;
}

}  // namespace trocar::collision
