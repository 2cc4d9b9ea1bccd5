// SPDX-License-Identifier: Apache-2.0
/// \file banded_distance.h  Exact distances near a border, quickly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace trocar::meshing {

inline constexpr int kWidestBand = 120;  ///< [pixels]; squares of it and their sums fit 16 bits

/// Signed distance to the border of the set pixels as CalcSignedDistances, exact where it is at most `band`,
/// and
/// +-(band + 0.5) beyond. In each row only the columns within the band are looked at.
/// \param set  (height * width), 0 or 1
/// \param band  1 to kWidestBand [pixels]
/// \return (height * width) [pixels], > 0 inside
std::vector<float> CalcBandedDistances(std::span<const std::uint8_t> set, int width, int height, int band);

}  // namespace trocar::meshing
