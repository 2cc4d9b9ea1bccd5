// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/edge_adaption.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trocar/anatomy/contour_spline.h"
#include "trocar/core/assert.h"

namespace trocar::anatomy {
namespace {

constexpr double kStep = 0.5;  // distance between the places tried along a normal [pixels]
// the parabola spans a whole pixel to either side: bilinear samples in between carry the pixel grid's pattern
constexpr int kPad = 2;  // steps
using Colour = std::array<float, 3>;

/// Part of a picture, blurred by a Gaussian.
class BlurredCrop {
 public:
  BlurredCrop(const ColorImage& image, int x0, int y0, int x1, int y1, double sigma)
      : x0_(x0), y0_(y0), width_(x1 - x0 + 1), height_(y1 - y0 + 1) {
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    std::vector<float> kernel(2 * radius + 1);
    float sum = 0;
    for (int i = -radius; i <= radius; ++i) {
      kernel[i + radius] = static_cast<float>(std::exp(-0.5 * i * i / (sigma * sigma)));
      sum += kernel[i + radius];
    }
    for (float& weight : kernel) weight /= sum;
    // along rows, then along columns; pixels beyond the picture repeat its border
    const int tall = height_ + 2 * radius;
    std::vector<Colour> rows(static_cast<std::size_t>(width_) * tall);
    for (int y = 0; y < tall; ++y) {
      const int source_y = std::clamp(y0 + y - radius, 0, image.height - 1);
      for (int x = 0; x < width_; ++x) {
        Colour value = {0, 0, 0};
        for (int k = -radius; k <= radius; ++k) {
          const auto* sample = image.At(std::clamp(x0 + x + k, 0, image.width - 1), source_y);
          for (int c = 0; c < 3; ++c) value[c] += kernel[k + radius] * sample[c];
        }
        rows[static_cast<std::size_t>(y) * width_ + x] = value;
      }
    }
    pixels_.resize(static_cast<std::size_t>(width_) * height_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        Colour value = {0, 0, 0};
        for (int k = 0; k <= 2 * radius; ++k) {
          const Colour& sample = rows[static_cast<std::size_t>(y + k) * width_ + x];
          for (int c = 0; c < 3; ++c) value[c] += kernel[k] * sample[c];
        }
        pixels_[static_cast<std::size_t>(y) * width_ + x] = value;
      }
    }
  }

  Colour Sample(const Vec2& p) const {
    const double x = std::clamp(p.x - x0_, 0.0, width_ - 1.001),
                 y = std::clamp(p.y - y0_, 0.0, height_ - 1.001);
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
    const Colour* row = &pixels_[static_cast<std::size_t>(iy) * width_ + ix];
    Colour value;
    for (int c = 0; c < 3; ++c) {
      const float top = row[0][c] * (1 - fx) + row[1][c] * fx;
      const float low = row[width_][c] * (1 - fx) + row[width_ + 1][c] * fx;
      value[c] = top * (1 - fy) + low * fy;
    }
    return value;
  }

 private:
  int x0_, y0_, width_, height_;
  std::vector<Colour> pixels_;
};

/// Outward or inward normal at each corner: perpendicular to the line between its neighbours.
std::vector<Vec2> CalcNormals(std::span<const Vec2> contour) {
  const std::size_t n = contour.size();
  std::vector<Vec2> normals(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 along = contour[(i + 1) % n] - contour[(i + n - 1) % n];
    const double length = Norm(along);
    if (length > 0) normals[i] = {along.y / length, -along.x / length};
  }
  return normals;
}

/// Shift index of each point with the least total cost around the closed contour.
std::vector<int> SolveClosed(const std::vector<std::vector<double>>& cost, double smoothness) {
  const std::size_t n = cost.size();
  const int states = static_cast<int>(cost.front().size());
  std::vector<int> best_path(n, states / 2);
  double best_cost = std::numeric_limits<double>::max();
  std::vector<std::vector<int>> from(n, std::vector<int>(states, 0));
  for (int start = 0; start < states; ++start) {
    std::vector<double> reach(states, std::numeric_limits<double>::max());
    reach[start] = cost[0][start];
    for (std::size_t i = 1; i < n; ++i) {
      std::vector<double> next(states, std::numeric_limits<double>::max());
      for (int b = 0; b < states; ++b) {
        for (int a = 0; a < states; ++a) {
          if (reach[a] == std::numeric_limits<double>::max()) continue;
          const double jump = (a - b) * kStep;
          const double total = reach[a] + smoothness * jump * jump + cost[i][b];
          if (total < next[b]) next[b] = total, from[i][b] = a;
        }
      }
      reach = std::move(next);
    }
    for (int end = 0; end < states; ++end) {
      const double jump = (end - start) * kStep;
      const double total = reach[end] + smoothness * jump * jump;
      if (!(total < best_cost)) continue;
      best_cost = total;
      int state = end;
      for (std::size_t i = n; i-- > 0;) {
        best_path[i] = state;
        if (i > 0) state = from[i][state];
      }
    }
  }
  return best_path;
}

}  // namespace

std::vector<Vec2> AdaptToEdges(const ColorImage& image, std::span<const Vec2> contour,
                               const EdgeAdaptionSettings& settings) {
  TROCAR_ASSERT(contour.size() >= 3);
  std::vector<Vec2> adapted(contour.begin(), contour.end());
  const int reach = static_cast<int>(std::floor(settings.max_shift_px / kStep));
  if (reach < 1) return adapted;

  Vec2 low = contour[0], high = contour[0];
  for (const Vec2& p : contour) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const double margin = settings.max_shift_px + 3.0;
  const BlurredCrop picture(image, static_cast<int>(low.x - margin) - 1, static_cast<int>(low.y - margin) - 1,
                            static_cast<int>(high.x + margin) + 2, static_cast<int>(high.y + margin) + 2,
                            settings.blur_px);

  // colour change along the normal at each shift, averaged along the contour; kPad more on both sides
  const std::size_t n = contour.size();
  const int states = 2 * reach + 1;
  const auto normals = CalcNormals(contour);
  std::vector<std::vector<double>> gradient(n, std::vector<double>(states + 2 * kPad));
  double strongest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < states + 2 * kPad; ++k) {
      const Vec2 p = contour[i] + ((k - kPad - reach) * kStep) * normals[i];
      Colour change = {0, 0, 0};
      for (int across = -1; across <= 1; ++across) {
        const Vec2 q = p + static_cast<double>(across) * Vec2{-normals[i].y, normals[i].x};
        const Colour ahead = picture.Sample(q + 0.5 * normals[i]),
                     behind = picture.Sample(q - 0.5 * normals[i]);
        for (int c = 0; c < 3; ++c) change[c] += (across == 0 ? 0.5f : 0.25f) * (ahead[c] - behind[c]);
      }
      double squared = 0;
      for (int c = 0; c < 3; ++c) squared += change[c] * change[c];
      gradient[i][k] = std::sqrt(squared);
      strongest = std::max(strongest, gradient[i][k]);
    }
  }
  if (!(strongest >= settings.min_gradient) || strongest == 0.0) return adapted;

  // reward only true edges: local maxima along the normal that are strong enough
  const auto is_edge = [&](std::size_t i, int state) {
    const double here = gradient[i][state + kPad];
    return here >= settings.min_gradient && here >= gradient[i][state + kPad - 1] &&
           here >= gradient[i][state + kPad + 1];
  };
  std::vector<std::vector<double>> cost(n, std::vector<double>(states, 0.0));
  for (std::size_t i = 0; i < n; ++i) {
    const double scale = *std::max_element(gradient[i].begin(), gradient[i].end());
    for (int state = 0; state < states; ++state) {
      const double away = std::abs(state - reach) / static_cast<double>(reach);
      cost[i][state] = 0.02 * away;  // with no edge anywhere, staying costs least
      if (is_edge(i, state))
        cost[i][state] -= (1.0 - settings.nearness * away * away) * gradient[i][state + kPad] / scale;
    }
  }
  const auto path = SolveClosed(cost, settings.smoothness);

  std::vector<double> shifts(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_edge(i, path[i])) continue;
    const double before = gradient[i][path[i]], here = gradient[i][path[i] + kPad],
                 after = gradient[i][path[i] + 2 * kPad];
    const double bend = before - 2 * here + after;
    const double offset = bend < 0 ? std::clamp(0.5 * kPad * (before - after) / bend, -1.0, 1.0) : 0.0;
    shifts[i] = std::clamp((path[i] - reach + offset) * kStep, -settings.max_shift_px, settings.max_shift_px);
  }

  // inside the picture, and never across itself
  const bool did_cross = CrossesItself(contour);
  for (double part = 1.0; part > 0.1; part *= 0.5) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 moved = contour[i] + (part * shifts[i]) * normals[i];
      adapted[i] = {std::clamp(moved.x, 0.0, image.width - 1.0),
                    std::clamp(moved.y, 0.0, image.height - 1.0)};
    }
    if (did_cross || !CrossesItself(adapted)) return adapted;
  }
  return {contour.begin(), contour.end()};
}

}  // namespace trocar::anatomy
