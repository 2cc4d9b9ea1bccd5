// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/organ_colour.h"

#include <algorithm>

#include "trocar/roles/roles.h"

namespace trocar::editor {
namespace {

constexpr render::SrgbColour kPalette[] = {{0.90, 0.52, 0.42}, {0.52, 0.86, 0.50}, {0.62, 0.60, 0.98},
                                           {0.98, 0.78, 0.40}, {0.90, 0.55, 0.85}, {0.45, 0.85, 0.88}};

}  // namespace

render::SrgbColour OrganColour(const std::string& name, int structure) {
  if (name == NameOf(roles::OrganRole::kLiver)) return kPalette[0];
  if (name == NameOf(roles::OrganRole::kGallbladder)) return kPalette[1];
  return kPalette[2 + std::max(structure, 0) % 4];
}

}  // namespace trocar::editor
