// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_propagation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "edge_strip.h"
#include "trocar/base/assert.h"
#include "trocar/contours/contour_spline.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kRowStep = 2.0;     // distance of the rows of the band [pixels]
constexpr double kColumnStep = 1.0;  // of its columns [pixels]
constexpr int kWindowRows = 4;       // matched together, to either side
constexpr int kMaxJump = 2;          // columns between neighbouring rows
// colours that vary less than this are noise and correlate with nothing [grey levels]
constexpr float kNoise = 4.0f;

/// Sums for the correlation of one row, or of several.
struct Sums {
  std::array<float, 3> f = {}, g = {}, ff = {}, gg = {}, fg = {};

  void Add(const Colour& a, const Colour& b) {
    for (std::size_t c = 0; c < 3; ++c) {
      f[c] += a[c], g[c] += b[c];
      ff[c] += a[c] * a[c], gg[c] += b[c] * b[c], fg[c] += a[c] * b[c];
    }
  }
  void Add(const Sums& other) {
    for (std::size_t c = 0; c < 3; ++c) {
      f[c] += other.f[c], g[c] += other.g[c];
      ff[c] += other.ff[c], gg[c] += other.gg[c], fg[c] += other.fg[c];
    }
  }
  float Correlation(float count) const {
    float covariance = 0, variance_f = 0, variance_g = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      covariance += fg[c] - f[c] * g[c] / count;
      variance_f += ff[c] - f[c] * f[c] / count;
      variance_g += gg[c] - g[c] * g[c] / count;
    }
    const float floor = 3 * count * kNoise * kNoise;
    return covariance / std::sqrt((variance_f + floor) * (variance_g + floor));
  }
};

/// Correlation of the bands at every row and shift, (rows * (2 shifts + 1)).
std::vector<float> CorrelateBands(const EdgeStrip& from, const EdgeStrip& to) {
  const int shifts = to.reach - from.reach, columns = 2 * shifts + 1;
  const auto n = static_cast<int>(from.rows);
  std::vector<Sums> sums(from.rows * columns);
  for (int row = 0; row < n; ++row) {
    for (int s = 0; s < columns; ++s) {
      Sums& sum = sums[static_cast<std::size_t>(row) * columns + s];
      for (int k = 0; k < from.Columns(); ++k) sum.Add(from.Row(row)[k], to.Row(row)[k + s]);
    }
  }
  const int window = std::min(kWindowRows, (n - 1) / 2);
  const auto count = static_cast<float>((2 * window + 1) * from.Columns());
  std::vector<float> correlation(sums.size());
  for (int row = 0; row < n; ++row) {
    for (int s = 0; s < columns; ++s) {
      Sums all;
      for (int w = -window; w <= window; ++w)
        all.Add(sums[static_cast<std::size_t>((row + w + n) % n) * columns + s]);
      correlation[static_cast<std::size_t>(row) * columns + s] = all.Correlation(count);
    }
  }
  return correlation;
}

}  // namespace

PropagatedContour PropagateContour(const images::ColorImage& from, const images::ColorImage& to,
                                   std::span<const Vec2> points, const PropagationSettings& settings) {
  return PropagateContour(EdgeField(from, settings.adaption.blur_px),
                          EdgeField(to, settings.adaption.blur_px), points, settings);
}

PropagatedContour PropagateContour(const EdgeField& from, const EdgeField& to, std::span<const Vec2> points,
                                   const PropagationSettings& settings) {
  TROCAR_ASSERT(points.size() >= 3 && from.Width() == to.Width() && from.Height() == to.Height());
  TROCAR_ASSERT(settings.max_shift_px > 0 && settings.band_px > 0);
  const ClosedCurve curve = ResampleClosed(FitContour(points), kRowStep);
  const EdgeStrip band = SampleStrip(from, curve, settings.band_px, kColumnStep);
  const EdgeStrip wide = SampleStrip(to, curve, settings.band_px + settings.max_shift_px, kColumnStep);
  const int shifts = wide.reach - band.reach, columns = 2 * shifts + 1;
  const auto correlation = CorrelateBands(band, wide);

  std::vector<float> cost(correlation.size());
  for (std::size_t i = 0; i < cost.size(); ++i) {
    // where nothing tells, staying costs least
    const double away = std::abs(static_cast<int>(i % columns) - shifts) / static_cast<double>(shifts);
    cost[i] = 1.0f - correlation[i] + static_cast<float>(0.02 * away * away);
  }
  const auto path = FindClosedPath(cost, band.rows, columns, settings.smoothness, kMaxJump);

  PropagatedContour result;
  for (const Vec2& p : points) {
    std::size_t row = 0;
    for (std::size_t i = 1; i < curve.at.size(); ++i) {
      if (Norm(curve.at[i] - p) < Norm(curve.at[row] - p)) row = i;
    }
    const float* here = &correlation[row * columns];
    const int at = path[row];
    double offset = 0.0;
    if (at > 0 && at + 1 < columns) {
      const double bend = here[at - 1] - 2.0 * here[at] + here[at + 1];
      if (bend < 0) offset = std::clamp(0.5 * (here[at - 1] - here[at + 1]) / bend, -0.5, 0.5);
    }
    const Vec2 moved = p + ((at - shifts + offset) * kColumnStep) * curve.normal[row];
    result.points.push_back(
        {std::clamp(moved.x, 0.0, to.Width() - 1.0), std::clamp(moved.y, 0.0, to.Height() - 1.0)});
    result.confidence.push_back(std::clamp(static_cast<double>(here[at]), 0.0, 1.0));
  }
  if (settings.is_adapting) result.points = AdaptToEdges(to, result.points, settings.adaption);
  return result;
}

}  // namespace trocar::contours
