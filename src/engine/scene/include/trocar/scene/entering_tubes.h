// SPDX-License-Identifier: Apache-2.0
/// \file entering_tubes.h  Ducts and arteries that end in an organ, among the rows of a patient's tissue.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/scene/tissue_layout.h"
#include "trocar/surgery/organ_attachment.h"

namespace trocar::scene {

/// A tube's nodes, from that organ on where it ends there.
/// \param organ  among the surfaces, or -1
std::vector<std::uint32_t> ListNodesFrom(const SurfaceInfo& tube, std::int32_t organ);

/// \param surfaces  organs, then tubes
/// \param strands   (strands)
/// \param organ     among the surfaces; -1: nothing enters it
std::vector<surgery::EnteringTube> FindEnteringTubes(std::span<const SurfaceInfo> surfaces,
                                                     std::span<const StrandInfo> strands, std::int32_t organ);

}  // namespace trocar::scene
