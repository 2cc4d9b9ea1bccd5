// SPDX-License-Identifier: Apache-2.0
/// \file small_solver.h  Linear systems of a few unknowns, whose capacity is known when compiling.
/// Source: Businger, Golub, "Linear least squares solutions by Householder transformations", Numerische Mathematik 1965.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
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

/// Least squares of rows x = b by Householder's reflections, the longest column first.
///
/// \param[in,out] rows  as many as b has, or more unknowns than rows; spent afterwards
/// \param[in,out] b     spent afterwards
/// \return  x; an unknown that the rows do not determine beside the others is 0
/// \note Real-time safe.
template <std::size_t kCount>
SmallVector<kCount> SolveLeastSquares(std::span<SmallVector<kCount>> rows, std::span<double> b) noexcept {
  std::array<std::size_t, kCount> unknown;  // of each column
  std::iota(unknown.begin(), unknown.end(), std::size_t{0});
  double least = 0.0;  // a column that is no longer than this depends on those before it
  std::size_t rank = 0;
  for (; rank < kCount && rank < rows.size(); ++rank) {
    std::size_t pivot = rank;
    double longest2 = -1.0;
    for (std::size_t column = rank; column < kCount; ++column) {
      double sum = 0.0;
      for (std::size_t i = rank; i < rows.size(); ++i) sum += rows[i][column] * rows[i][column];
      if (sum > longest2) longest2 = sum, pivot = column;
    }
    const double length = std::sqrt(longest2);
    if (rank == 0) least = kCount * std::numeric_limits<double>::epsilon() * length;
    if (!(length > least)) break;
    if (pivot != rank) {
      for (SmallVector<kCount>& row : rows) std::swap(row[rank], row[pivot]);
      std::swap(unknown[rank], unknown[pivot]);
    }
    // the reflection that takes the column to (diagonal, 0, ...) is I - v v^T / half, v the column less that
    const double first = rows[rank][rank], diagonal = first > 0.0 ? -length : length;
    const double half = length * (length + std::fabs(first));
    rows[rank][rank] -= diagonal;
    const auto reflect = [&](auto&& entry) {
      double sum = 0.0;
      for (std::size_t i = rank; i < rows.size(); ++i) sum += rows[i][rank] * entry(i);
      const double share = sum / half;
      for (std::size_t i = rank; i < rows.size(); ++i) entry(i) -= share * rows[i][rank];
    };
    for (std::size_t column = rank + 1; column < kCount; ++column)
      reflect([&](std::size_t i) -> double& { return rows[i][column]; });
    reflect([&](std::size_t i) -> double& { return b[i]; });
    rows[rank][rank] = diagonal;
  }
  SmallVector<kCount> x{};
  for (std::size_t c = rank; c-- > 0;) {
    double sum = b[c];
    for (std::size_t k = c + 1; k < rank; ++k) sum -= rows[c][k] * x[unknown[k]];
    x[unknown[c]] = sum / rows[c][c];
  }
  return x;
}

}  // namespace trocar::math
