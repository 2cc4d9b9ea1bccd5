// SPDX-License-Identifier: Apache-2.0
/// \file small_solver.h  Linear systems of a few unknowns, whose capacity is known when compiling.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace trocar::math {

template <std::size_t kMost>
using SmallVector = std::array<double, kMost>;
template <std::size_t kMost>
using SmallMatrix = std::array<SmallVector<kMost>, kMost>;

enum class Pivots {
  kRows,  ///< the largest entry below: for any matrix; a singular one is refused
  kNone   ///< the diagonal as it stands, for a Gram matrix: an unknown without a positive pivot becomes 0
};

/// Solves a x = b for the first `count` rows by elimination.
///
/// \param[out] x  (count); what stands behind stays
/// \return false where a matrix with row pivots is singular
/// \note Real-time safe.
template <Pivots pivots, std::size_t kMost>
bool SolveSmall(SmallMatrix<kMost> a, SmallVector<kMost> b, std::size_t count,
                SmallVector<kMost>& x) noexcept {
  const auto is_usable = [&a](std::size_t c) { return pivots == Pivots::kRows || a[c][c] > 0.0; };
  for (std::size_t c = 0; c < count; ++c) {
    if constexpr (pivots == Pivots::kRows) {
      std::size_t pivot = c;
      for (std::size_t row = c + 1; row < count; ++row) {
        if (std::fabs(a[row][c]) > std::fabs(a[pivot][c])) pivot = row;
      }
      if (!(std::fabs(a[pivot][c]) > 0.0)) return false;
      std::swap(a[pivot], a[c]);
      std::swap(b[pivot], b[c]);
    }
    for (std::size_t row = c + 1; row < count; ++row) {
      const double factor = is_usable(c) ? a[row][c] / a[c][c] : 0.0;
      for (std::size_t k = c; k < count; ++k) a[row][k] -= factor * a[c][k];
      b[row] -= factor * b[c];
    }
  }
  for (std::size_t c = count; c-- > 0;) {
    double sum = b[c];
    for (std::size_t k = c + 1; k < count; ++k) sum -= a[c][k] * x[k];
    x[c] = is_usable(c) ? sum / a[c][c] : 0.0;
  }
  return true;
}

}  // namespace trocar::math
