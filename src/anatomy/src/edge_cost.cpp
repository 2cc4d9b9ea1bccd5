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
constexpr double kGapPx = 1.5;     // next to the curve, where the colours mix [pixels]
constexpr double kNoise = 4.0;     // colours differ by this much within one tissue anyway [grey levels]
constexpr double kClearest = 2.0;  // log-likelihood ratios are cut off here [-]

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

struct Bands {
  Moments inside, outside;
};

/// Solves the symmetric system a x = b by Cramer's rule; a is positive definite.
Vec Solve(const std::array<double, 6>& a, const Vec& b) {
  const double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[2] * a[4] - a[1] * a[5], c2 = a[1] * a[4] - a[2] * a[3];
  const double det = a[0] * c0 + a[1] * c1 + a[2] * c2;
  const double c3 = a[0] * a[5] - a[2] * a[2], c4 = a[1] * a[2] - a[0] * a[4], c5 = a[0] * a[3] - a[1] * a[1];
  return {(c0 * b[0] + c1 * b[1] + c2 * b[2]) / det, (c1 * b[0] + c3 * b[1] + c4 * b[2]) / det,
          (c2 * b[0] + c4 * b[1] + c5 * b[2]) / det};
}

double Dot3(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Combination of the channels that tells the two sides apart.
struct Fisher {
  std::array<float, 3> weight;       // unit length; the value falls outwards
  double middle = 0, certainty = 0;  // value between the sides; log-likelihood ratio a grey level
};

Fisher Separate(const Bands& bands) {
  const Vec in = bands.inside.Mean(), out = bands.outside.Mean();
  const Vec away = {in[0] - out[0], in[1] - out[1], in[2] - out[2]};
  const auto scatter_in = bands.inside.Scatter(), scatter_out = bands.outside.Scatter();
  const double count = bands.inside.count + bands.outside.count;
  std::array<double, 6> spread;
  for (std::size_t i = 0; i < 6; ++i) spread[i] = (scatter_in[i] + scatter_out[i]) / count;
  for (const std::size_t i : {0, 3, 5}) spread[i] += kNoise * kNoise;
  const Vec w = Solve(spread, away);
  const double norm = std::sqrt(Dot3(w, w));
  Fisher fisher{};
  if (!(norm > 0)) return fisher;
  for (std::size_t i = 0; i < 3; ++i) fisher.weight[i] = static_cast<float>(w[i] / norm);
  fisher.middle = 0.5 * (Dot3(w, in) + Dot3(w, out)) / norm;
  fisher.certainty = norm;  // linear discriminant: w . (c - middle) is the log-likelihood ratio
  return fisher;
}

}  // namespace

EdgeEvidence CalcEdgeEvidence(const EdgeStrip& strip, double reach_px, double row_px) {
  EdgeEvidence evidence;
  evidence.reach = static_cast<int>(std::floor(reach_px / strip.step_px + 1e-9));
  const int columns = evidence.Columns(), all = strip.Columns(), pad = strip.reach - evidence.reach;
  TROCAR_ASSERT(pad >= 1);
  const auto rows = static_cast<int>(strip.rows);

  // colours of either side, of each row and then of the rows about it
  const int gap = static_cast<int>(std::ceil(kGapPx / strip.step_px));
  std::vector<Bands> bands(strip.rows);
  for (int row = 0; row < rows; ++row) {
    const Colour* colours = strip.Row(row);
    for (int k = 0; k <= strip.reach - gap; k += 2) {
      bands[row].inside.Add(colours[k]);
      bands[row].outside.Add(colours[all - 1 - k]);
    }
  }
  const int window = std::min(static_cast<int>(kWindowPx / row_px), (rows - 1) / 2);
  Bands about;
  const auto slide = [&](int row, double sign) {
    const Bands& one = bands[static_cast<std::size_t>((row % rows + rows) % rows)];
    about.inside.Add(one.inside, sign), about.outside.Add(one.outside, sign);
  };
  for (int row = -window; row <= window; ++row) slide(row, 1);

  evidence.gradient.resize(strip.rows * columns), evidence.region.resize(strip.rows * columns);
  std::vector<float> value(all);
  for (int row = 0; row < rows; ++row) {
    const Fisher fisher = Separate(about);
    const Colour* colours = strip.Row(row);
    for (int k = 0; k < all; ++k) {
      value[k] = 0;
      for (std::size_t c = 0; c < 3; ++c) value[k] += fisher.weight[c] * colours[k][c];
    }
    float* gradient = &evidence.gradient[static_cast<std::size_t>(row) * columns];
    float* region = &evidence.region[static_cast<std::size_t>(row) * columns];
    double cost = 0, least = 0;
    for (int k = 0; k < columns; ++k) {
      const float* here = &value[k + pad];
      gradient[k] = (here[-1] - here[1]) / static_cast<float>(2 * strip.step_px);
      // the places before the border are paid for if they look like the outside
      const double ratio = (fisher.middle - here[-1]) * fisher.certainty;
      cost += std::clamp(ratio, -kClearest, kClearest) / kClearest * strip.step_px;
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
