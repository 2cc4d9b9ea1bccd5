// SPDX-License-Identifier: Apache-2.0
/// \file band_matrix.h  Symmetric banded systems by L D L^T, in place and without exchanging rows.
#pragma once

#include <cstddef>
#include <span>

namespace trocar::rod {

/// Unknowns of a node: its position and the angle of the segment behind it.
inline constexpr std::size_t kNodeUnknowns = 4;
/// A node's bending and twist join it to the nodes beside it: eleven unknowns in a row.
inline constexpr std::size_t kElementUnknowns = 2 * kNodeUnknowns + 3;
/// Numbers kept of a row: its diagonal and what stands left of it.
inline constexpr std::size_t kBandWidth = kElementUnknowns;

/// Entry (row, column) of the lower half.
///
/// \pre column <= row < column + kBandWidth
inline std::size_t BandAt(std::size_t row, std::size_t column) {
  return row * kBandWidth + (kBandWidth - 1) + column - row;
}

/// Factors a matrix: below the diagonal L, on it D.
///
/// \param[in,out] band  (rows, kBandWidth)
/// \return false where a pivot is not above a rounding error of its diagonal entry: the matrix counts as not positive definite,
///         and the rest of it is not factored
/// \note Real-time safe.
bool FactorBand(std::span<double> band) noexcept;

/// Solves with FactorBand's result.
///
/// \param[in,out] x  (rows) the right side, then the solution
/// \note Real-time safe.
void SolveBand(std::span<const double> band, std::span<double> x) noexcept;

}  // namespace trocar::rod
