// SPDX-License-Identifier: Apache-2.0
/// \file smallest_ritz.h  Smallest Ritz value: the estimate by conjugate gradients of the softest mode that they have met.
///
/// The factors of k steps make a tridiagonal matrix whose eigenvalues (Ritz values) approach those of the preconditioned matrix, the
/// smallest from above (Golub and Meurant, "Matrices, Moments and Quadrature with Applications", 2010,
/// section 4.2). What a preconditioned residual z hides of the error is at most 1 / the smallest.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace trocar::math {

/// Smallest Ritz value of a run of conjugate gradients, step by step.
class SmallestRitz {
 public:
  /// Steps that are taken in; what comes later adds nothing.
  static constexpr std::size_t kMaxSteps = 96;

  /// Takes one step in: x += alpha p, of p = z + beta p (0 in the first).
  void Add(double alpha, double beta) noexcept {
    if (count_ == kMaxSteps || !(alpha > 0.0)) return;
    diagonal_[count_] = 1.0 / alpha + (count_ > 0 ? beta / last_alpha_ : 0.0);
    // squared
    beside_[count_] = count_ > 0 ? beta / (last_alpha_ * last_alpha_) : 0.0;
    last_alpha_ = alpha;
    ++count_;
    // eigenvalues of a matrix with one more row lie between those before: it only sinks
    double low = 0.0, high = count_ == 1 ? diagonal_[0] : value_;
    if (count_ == 1) {
      value_ = high;
      return;
    }
    for (int halving = 0; halving < kHalvings && high > kRelative * 1e-6; ++halving) {
      const double middle = 0.5 * (low + high);
      (HasBelow(middle) ? high : low) = middle;
      if (high - low <= kRelative * high) break;
    }
    value_ = high;
  }
  /// The smallest so far [-]; infinite before the first step.
  double Value() const noexcept { return value_; }

 private:
  static constexpr int kHalvings = 40;
  static constexpr double kRelative = 0.02;

  /// True where an eigenvalue is below `limit`: a pivot of T - limit I is negative (Sturm).
  bool HasBelow(double limit) const noexcept {
    double pivot = diagonal_[0] - limit;
    for (std::size_t i = 1; pivot > 0.0 && i < count_; ++i) pivot = diagonal_[i] - limit - beside_[i] / pivot;
    return !(pivot > 0.0);
  }

  std::array<double, kMaxSteps> diagonal_{}, beside_{};
  std::size_t count_ = 0;
  double last_alpha_ = 0, value_ = INFINITY;
};

}  // namespace trocar::math
