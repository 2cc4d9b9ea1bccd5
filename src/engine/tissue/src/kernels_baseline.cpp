// SPDX-License-Identifier: Apache-2.0
/// \file kernels_baseline.cpp  The inner loops, what every processor of the architecture has.
#define TROCAR_LANES 4
#include "kernel_level.h"

namespace trocar::tissue {

const Kernels& GetKernelsBaseline() noexcept {
  return kKernels;
}

}  // namespace trocar::tissue
