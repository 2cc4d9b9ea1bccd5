// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/edge_adaption.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/contour_spline.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kStep = 0.5;  // distance between the places tried along a normal [pixels]
// the parabola spans a whole pixel to either side: bilinear samples in between carry the pixel grid's pattern
constexpr int kPad = 2;  // steps

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

std::vector<Vec2> AdaptToEdges(const images::ColorImage& image, std::span<const Vec2> contour,
                               const EdgeAdaptionSettings& settings) {
  return AdaptToEdges(EdgeField(image, settings.blur_px), contour, settings);
}

std::vector<Vec2> AdaptToEdges(const EdgeField& picture, std::span<const Vec2> contour,
                               const EdgeAdaptionSettings& settings) {
  TROCAR_ASSERT(contour.size() >= 3);
  std::vector<Vec2> adapted(contour.begin(), contour.end());
  const int reach = base::FloorTo<int>(settings.max_shift_px / kStep);
  if (reach < 1) return adapted;

  // colour change along the normal at each shift, averaged along the contour; kPad more on both sides
  const std::size_t n = contour.size();
  const int states = 2 * reach + 1;
  const auto normals = CalcNormals(contour);
  std::vector<std::vector<double>> gradient(n, std::vector<double>(states + 2 * kPad));
  double strongest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < states + 2 * kPad; ++k) {
      const Vec2 p = contour[i] + ((k - kPad - reach) * kStep) * normals[i];
      Colour change = {};
      for (int across = -1; across <= 1; ++across) {
        const Vec2 q = p + static_cast<double>(across) * Vec2{-normals[i].y, normals[i].x};
        const Colour ahead = picture.Sample(q + 0.5 * normals[i]),
                     behind = picture.Sample(q - 0.5 * normals[i]);
        for (std::size_t c = 0; c < 3; ++c)
          change[c] += (across == 0 ? 0.5f : 0.25f) * (ahead[c] - behind[c]);
      }
      double squared = 0;
      for (std::size_t c = 0; c < 3; ++c) squared += change[c] * change[c];
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
      adapted[i] = {std::clamp(moved.x, 0.0, picture.Width() - 1.0),
                    std::clamp(moved.y, 0.0, picture.Height() - 1.0)};
    }
    if (did_cross || !CrossesItself(adapted)) return adapted;
  }
  return {contour.begin(), contour.end()};
}

}  // namespace trocar::contours
