// SPDX-License-Identifier: Apache-2.0
/// \file wide_kernels_avx2.cpp  The loops over a WideTree, compiled for one level of vector instructions.
#if defined(__x86_64__)
#include "wide_kernel_bodies.h"

namespace trocar::collision {

const WideKernels& GetWideKernelsAvx2() noexcept {
  static constexpr WideKernels kKernels = {ConvertPoints, RefitNodes, SearchPoint, SearchSegment};
  return kKernels;
}

}  // namespace trocar::collision
#endif
