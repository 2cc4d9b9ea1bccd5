// SPDX-License-Identifier: Apache-2.0
/// \file organ_colour.h  Colour of an organ in the contour window: in the picture, the list and the 3-D view.
#pragma once

#include <string>

#include "trocar/render/figure.h"

namespace trocar::editor {

/// \param structure  its place among the organs, >= 0
render::SrgbColour OrganColour(const std::string& name, int structure);

}  // namespace trocar::editor
