// SPDX-License-Identifier: Apache-2.0
#include "band_matrix.h"

#include <algorithm>

namespace trocar::rod {
namespace {

/// A pivot below this part of its diagonal entry is what rounding left [-].
constexpr double kLeastPivot = 1e-13;

/// First column of a row that the band holds.
std::size_t FirstOf(std::size_t row) {
  return row - std::min(row, kBandWidth - 1);
}

}  // namespace

bool FactorBand(std::span<double> band) noexcept {
  const std::size_t rows = band.size() / kBandWidth;
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t first = FirstOf(row);
    // row of L D, from the rows above
    for (std::size_t column = first; column < row; ++column) {
      double sum = band[BandAt(row, column)];
      for (std::size_t k = std::max(first, FirstOf(column)); k < column; ++k)
        sum -= band[BandAt(row, k)] * band[BandAt(column, k)];
      band[BandAt(row, column)] = sum;
    }
    // divided by D it is L's
    const double diagonal = band[BandAt(row, row)];
    double pivot = diagonal;
    for (std::size_t k = first; k < row; ++k) {
      double& entry = band[BandAt(row, k)];
      const double scaled = entry / band[BandAt(k, k)];
      pivot -= entry * scaled;
      entry = scaled;
    }
    if (!(pivot > kLeastPivot * diagonal && diagonal > 0.0)) return false;
    band[BandAt(row, row)] = pivot;
  }
  return true;
}

void SolveBand(std::span<const double> band, std::span<double> x) noexcept {
  const std::size_t rows = x.size();
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t k = FirstOf(row); k < row; ++k) x[row] -= band[BandAt(row, k)] * x[k];
  }
  for (std::size_t row = 0; row < rows; ++row) x[row] /= band[BandAt(row, row)];
  for (std::size_t row = rows; row-- > 0;) {
    for (std::size_t k = FirstOf(row); k < row; ++k) x[k] -= band[BandAt(row, k)] * x[row];
  }
}

}  // namespace trocar::rod
