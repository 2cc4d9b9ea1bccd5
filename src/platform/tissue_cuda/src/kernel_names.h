// SPDX-License-Identifier: Apache-2.0
/// \file kernel_names.h  Names of the entry points in kernels/kernels.cu.
#pragma once

#include <string>

#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

/// \param is_resident  of Layout::kTiled: which of its two kernels
inline std::string KernelName(Layout layout, bool is_single, bool is_resident) {
  std::string name = "trocar_";
  switch (layout) {
    case Layout::kPaperGlobal:
      name += "global";
      break;
    case Layout::kPaperCoalesced:
      name += "coalesced";
      break;
    case Layout::kPaperShared:
      name += "shared";
      break;
    case Layout::kPaperSharedCoalesced:
      name += "shared_coalesced";
      break;
    case Layout::kTiled:
      name += is_resident ? "tiled_resident" : "tiled_streaming";
      break;
  }
  return name + (is_single ? "_f32" : "_f64");
}

}  // namespace trocar::tissue_cuda
