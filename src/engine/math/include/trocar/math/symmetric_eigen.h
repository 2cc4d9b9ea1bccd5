// SPDX-License-Identifier: Apache-2.0
/// \file symmetric_eigen.h  Eigenvalues and eigenvectors of small symmetric matrices, by Jacobi's rotations.
/// Source: Golub, Van Loan, "Matrix Computations", 4th edition 2013, section 8.5.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "trocar/math/small_solver.h"

namespace trocar::math {

template <std::size_t kCount>
struct SymmetricEigen {
  SmallVector<kCount> values{};   ///< ascending
  SmallMatrix<kCount> vectors{};  ///< vectors[i] of values[i], of unit length, perpendicular to each other
};

/// Jacobi's cyclic method: each rotation makes one pair of entries zero, until all beside the diagonal are of rounding.
///
/// \param a  symmetric and finite; what stands below the diagonal is not read
/// \note Real-time safe.
template <std::size_t kCount>
SymmetricEigen<kCount> CalcSymmetricEigen(SmallMatrix<kCount> a) noexcept {
  // converges quadratically: six sweeps are usual
  constexpr int kMostSweeps = 30;
  SmallMatrix<kCount> columns{};
  for (std::size_t i = 0; i < kCount; ++i) columns[i][i] = 1.0;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double beside = 0.0, all = 0.0;
    for (std::size_t p = 0; p < kCount; ++p) {
      all += a[p][p] * a[p][p];
      for (std::size_t q = p + 1; q < kCount; ++q) beside += a[p][q] * a[p][q];
    }
    constexpr double kRounding = std::numeric_limits<double>::epsilon();
    if (!(beside > kRounding * kRounding * (all + beside))) break;
    for (std::size_t p = 0; p < kCount; ++p) {
      for (std::size_t q = p + 1; q < kCount; ++q) {
        if (a[p][q] == 0.0) continue;
        // the smaller of the two angles
        const double tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t = (tau >= 0.0 ? 1.0 : -1.0) / (std::fabs(tau) + std::sqrt(1.0 + tau * tau));
        const double c = 1.0 / std::sqrt(1.0 + t * t), s = t * c;
        a[p][p] -= t * a[p][q];
        a[q][q] += t * a[p][q];
        a[p][q] = 0.0;
        for (std::size_t k = 0; k < kCount; ++k) {
          if (k != p && k != q) {
            double& to_p = k < p ? a[k][p] : a[p][k];
            double& to_q = k < q ? a[k][q] : a[q][k];
            const double before = to_p;
            to_p = c * before - s * to_q;
            to_q = s * before + c * to_q;
          }
          const double before = columns[k][p];
          columns[k][p] = c * before - s * columns[k][q];
          columns[k][q] = s * before + c * columns[k][q];
        }
      }
    }
  }
  SymmetricEigen<kCount> result;
  for (std::size_t i = 0; i < kCount; ++i) {
    std::size_t place = i;
    for (; place > 0 && result.values[place - 1] > a[i][i]; --place) {
      result.values[place] = result.values[place - 1];
      result.vectors[place] = result.vectors[place - 1];
    }
    result.values[place] = a[i][i];
    for (std::size_t k = 0; k < kCount; ++k) result.vectors[place][k] = columns[k][i];
  }
  return result;
}

}  // namespace trocar::math
