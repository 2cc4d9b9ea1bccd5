// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::tissue_cuda {

std::string_view LayoutName(Layout layout) noexcept {
  switch (layout) {
    case Layout::kPaperGlobal:
      return "global";
    case Layout::kPaperCoalesced:
      return "coalesced";
    case Layout::kPaperShared:
      return "shared";
    case Layout::kPaperSharedCoalesced:
      return "shared-coalesced";
    case Layout::kTiled:
      return "tiled";
  }
  return "";
}

std::span<const Layout> AllLayouts() noexcept {
  static constexpr std::array kAll = {Layout::kPaperGlobal, Layout::kPaperCoalesced, Layout::kPaperShared,
                                      Layout::kPaperSharedCoalesced, Layout::kTiled};
  return kAll;
}

std::string_view PrecisionName(Precision precision) noexcept {
  return precision == Precision::kSingle ? "single" : "double";
}

}  // namespace trocar::tissue_cuda
