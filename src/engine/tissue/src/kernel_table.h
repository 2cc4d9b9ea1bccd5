// SPDX-License-Identifier: Apache-2.0
/// \file kernel_table.h  Where each version of the inner loops comes from.
#pragma once

#include "kernels.h"

namespace trocar::tissue {

const Kernels& GetKernelsBaseline() noexcept;
#if defined(__x86_64__)
const Kernels& GetKernelsAvx2() noexcept;
const Kernels& GetKernelsAvx512() noexcept;
#endif

}  // namespace trocar::tissue
