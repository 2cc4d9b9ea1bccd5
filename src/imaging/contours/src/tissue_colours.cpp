// SPDX-License-Identifier: Apache-2.0
#include "tissue_colours.h"

#include <cstddef>

namespace trocar::contours {
namespace {

using Vec = std::array<double, 3>;

constexpr double kNoise = 2.0;  // colours differ by this much within one tissue anyway [grey levels]

/// Solves the symmetric system a x = b by Cramer's rule; a is positive definite.
Vec Solve(const std::array<double, 6>& a, const Vec& b) {
  const double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[2] * a[4] - a[1] * a[5], c2 = a[1] * a[4] - a[2] * a[3];
  const double det = a[0] * c0 + a[1] * c1 + a[2] * c2;
  const double c3 = a[0] * a[5] - a[2] * a[2], c4 = a[1] * a[2] - a[0] * a[4], c5 = a[0] * a[3] - a[1] * a[1];
  return {(c0 * b[0] + c1 * b[1] + c2 * b[2]) / det, (c1 * b[0] + c3 * b[1] + c4 * b[2]) / det,
          (c2 * b[0] + c4 * b[1] + c5 * b[2]) / det};
}

}  // namespace

void ColourMoments::Add(const ColourMoments& other, double sign) {
  count += sign * other.count;
  for (std::size_t i = 0; i < 3; ++i) sum[i] += sign * other.sum[i];
  for (std::size_t i = 0; i < 6; ++i) products[i] += sign * other.products[i];
}

TissueColours::TissueColours(const ColourMoments& moments) {
  const Vec& sum = moments.sum;
  const auto& p = moments.products;
  mean_ = {sum[0] / moments.count, sum[1] / moments.count, sum[2] / moments.count};
  std::array<double, 6> spread = {p[0] - sum[0] * mean_[0], p[1] - sum[0] * mean_[1],
                                  p[2] - sum[0] * mean_[2], p[3] - sum[1] * mean_[1],
                                  p[4] - sum[1] * mean_[2], p[5] - sum[2] * mean_[2]};
  for (double& value : spread) value /= moments.count;
  for (const std::size_t i : {0, 3, 5}) spread[i] += kNoise * kNoise;
  const Vec x = Solve(spread, {1, 0, 0}), y = Solve(spread, {0, 1, 0}), z = Solve(spread, {0, 0, 1});
  inverse_ = {x[0], x[1], x[2], y[1], y[2], z[2]};
}

}  // namespace trocar::contours
