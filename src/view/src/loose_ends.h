// SPDX-License-Identifier: Apache-2.0
/// \file loose_ends.h  Scenery where the model of a duct or vessel stops: in a body it runs on inside fat.
#pragma once

#include <span>
#include <vector>

#include "fat_body.h"
#include "trocar/math/vector.h"

namespace trocar::view {

/// Centre line of a duct or vessel at the start.
using TubeLine = std::vector<math::Vec3>;

/// Lobules round the ends that lie near no other tube and near no organ, and on along them out of sight.
///
/// \param tubes   two points or more each, else it is left out [m]
/// \param organs  vertices of all organs [m]
/// \return  the same lobules for the same arguments
std::vector<FatLobule> CoverLooseEnds(std::span<const TubeLine> tubes, std::span<const math::Vec3> organs);

}  // namespace trocar::view
