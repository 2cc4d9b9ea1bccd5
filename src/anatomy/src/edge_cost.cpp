// SPDX-License-Identifier: Apache-2.0
#include "edge_cost.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "trocar/core/assert.h"

namespace trocar::anatomy {
namespace {

using Vec = std::array<double, 3>;

constexpr double kWindowPx =
    40.0;  // of the contour to either side from which a place learns its colours [pixels]
constexpr double kNoise = 2.0;  // colours differ by this much within one tissue anyway [grey levels]
constexpr int kAlongRows = 2;   // averaged to either side along the curve
constexpr double kFar = 3.0;    // a colour this many standard deviations away belongs to something else [-]
// the inside is learned up to this part of the reach from the curve, where it is not sure to be inside any
// more [-]
constexpr double kDoubtful = 0.3;

/// Sums of colours and of their products.
struct Moments {
  double count = 0;
  Vec sum = {};
  std::array<double, 6> products = {};  // xx xy xz yy yz zz

  void Add(const Colour& c) {
    count += 1;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += c[i];
    products[0] += static_cast<double>(c[0]) * c[0], products[1] += static_cast<double>(c[0]) * c[1];
    products[2] += static_cast<double>(c[0]) * c[2], products[3] += static_cast<double>(c[1]) * c[1];
    products[4] += static_cast<double>(c[1]) * c[2], products[5] += static_cast<double>(c[2]) * c[2];
  }
  void Add(const Moments& other, double sign) {
    count += sign * other.count;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += sign * other.sum[i];
    for (std::size_t i = 0; i < 6; ++i) products[i] += sign * other.products[i];
  }
  Vec Mean() const { return {sum[0] / count, sum[1] / count, sum[2] / count}; }
  /// count times the covariance
  std::array<double, 6> Scatter() const {
    const Vec m = Mean();
    return {products[0] - sum[0] * m[0], products[1] - sum[0] * m[1], products[2] - sum[0] * m[2],
            products[3] - sum[1] * m[1], products[4] - sum[1] * m[2], products[5] - sum[2] * m[2]};
  }
};

/// Solves the symmetric system a x = b by Cramer's rule; a is positive definite.
Vec Solve(const std::array<double, 6>& a, const Vec& b) {
  const double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[2] * a[4] - a[1] * a[5], c2 = a[1] * a[4] - a[2] * a[3];
  const double det = a[0] * c0 + a[1] * c1 + a[2] * c2;
  const double c3 = a[0] * a[5] - a[2] * a[2], c4 = a[1] * a[2] - a[0] * a[4], c5 = a[0] * a[3] - a[1] * a[1];
  return {(c0 * b[0] + c1 * b[1] + c2 * b[2]) / det, (c1 * b[0] + c3 * b[1] + c4 * b[2]) / det,
          (c2 * b[0] + c4 * b[1] + c5 * b[2]) / det};
}

/// What the inside looks like: a normal distribution of colours.
struct Tissue {
  Vec mean = {};
  std::array<double, 6> inverse = {};  // of the covariance

  double Distance(const Colour& c) const {
    const double x = c[0] - mean[0], y = c[1] - mean[1], z = c[2] - mean[2];
    return std::sqrt(std::max(0.0, inverse[0] * x * x + inverse[3] * y * y + inverse[5] * z * z +
                                       2 * (inverse[1] * x * y + inverse[2] * x * z + inverse[4] * y * z)));
  }
};

Tissue DescribeTissue(const Moments& moments) {
  auto spread = moments.Scatter();
  for (double& value : spread) value /= moments.count;
  for (const std::size_t i : {0, 3, 5}) spread[i] += kNoise * kNoise;
  const Vec x = Solve(spread, {1, 0, 0}), y = Solve(spread, {0, 1, 0}), z = Solve(spread, {0, 0, 1});
  return {moments.Mean(), {x[0], x[1], x[2], y[1], y[2], z[2]}};
}

}  // namespace

EdgeEvidence CalcEdgeEvidence(const EdgeStrip& strip, double reach_px, double row_px) {
  EdgeEvidence evidence;
  evidence.reach = static_cast<int>(std::floor(reach_px / strip.step_px + 1e-9));
  const int columns = evidence.Columns(), all = strip.Columns(), pad = strip.reach - evidence.reach;
  TROCAR_ASSERT(pad >= 1);
  const auto rows = static_cast<int>(strip.rows);

  // averaged along the curve, which blurs no edge that runs along it
  std::vector<Colour> smooth(strip.colours.size());
  const int along = std::min(kAlongRows, (rows - 1) / 2);
  for (int row = 0; row < rows; ++row) {
    Colour* to = &smooth[static_cast<std::size_t>(row) * all];
    for (int d = -along; d <= along; ++d) {
      const Colour* from = strip.Row(static_cast<std::size_t>((row + d + rows) % rows));
      for (int k = 0; k < all; ++k) {
        for (std::size_t c = 0; c < 4; ++c) to[k][c] += from[k][c] / static_cast<float>(2 * along + 1);
      }
    }
  }
  // colours of the inside, of each row and then of the rows about it
  std::vector<Moments> inside(strip.rows);
  const int deepest = strip.reach - static_cast<int>(kDoubtful * evidence.reach);
  for (int row = 0; row < rows; ++row) {
    const Colour* colours = &smooth[static_cast<std::size_t>(row) * all];
    for (int k = 0; k <= deepest; k += 2) inside[row].Add(colours[k]);
  }
  const int window = std::min(static_cast<int>(kWindowPx / row_px), (rows - 1) / 2);
  Moments about;
  const auto slide = [&](int row, double sign) {
    about.Add(inside[static_cast<std::size_t>((row % rows + rows) % rows)], sign);
  };
  for (int row = -window; row <= window; ++row) slide(row, 1);

  evidence.gradient.resize(strip.rows * columns), evidence.rise.resize(strip.rows * columns);
  evidence.region.resize(strip.rows * columns);
  std::vector<float> unlike(all);
  for (int row = 0; row < rows; ++row) {
    const Tissue tissue = DescribeTissue(about);
    const Colour* colours = &smooth[static_cast<std::size_t>(row) * all];
    for (int k = 0; k < all; ++k)
      unlike[k] = static_cast<float>(std::min(tissue.Distance(colours[k]), kFar) / kFar);
    float* gradient = &evidence.gradient[static_cast<std::size_t>(row) * columns];
    float* rise = &evidence.rise[static_cast<std::size_t>(row) * columns];
    float* region = &evidence.region[static_cast<std::size_t>(row) * columns];
    double cost = 0, least = 0;
    for (int k = 0; k < columns; ++k) {
      const int at = k + pad;
      float squared = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float change = colours[at + 1][c] - colours[at - 1][c];
        squared += change * change;
      }
      const auto width = static_cast<float>(2 * strip.step_px);
      gradient[k] = std::sqrt(squared) / width;
      rise[k] = (unlike[at + 1] - unlike[at - 1]) / width;
      cost += (2.0 * unlike[at - 1] - 1.0) * strip.step_px;
      region[k] = static_cast<float>(cost);
      least = k == 0 ? cost : std::min(least, cost);
    }
    for (int k = 0; k < columns; ++k) region[k] -= static_cast<float>(least);
    slide(row - window, -1);
    slide(row + window + 1, 1);
  }
  return evidence;
}

}  // namespace trocar::anatomy
