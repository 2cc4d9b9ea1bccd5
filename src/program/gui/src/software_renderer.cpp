// SPDX-License-Identifier: Apache-2.0
#include "trocar/gui/software_renderer.h"

namespace trocar::gui {

bool IsSoftwareRenderer(std::string_view renderer) noexcept {
  for (const std::string_view name : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer"})
    if (renderer.find(name) != std::string_view::npos) return true;
  return false;
}

}  // namespace trocar::gui
