// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_morph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "even_places.h"
#include "trocar/base/assert.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr double kStep = 2.0;            // distance of matched points [pixels]
constexpr double kNormalWeight = 200.0;  // cost of opposite normals / 2, against squared distance [pixels^2]

struct Points {
  std::vector<Vec2> at, normal;
};

/// Equal steps along the polyline, counter-clockwise.
Points Resample(std::span<const Vec2> contour) {
  const std::size_t n = contour.size();
  double area = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &p = contour[i], &q = contour[(i + 1) % n];
    area += p.x * q.y - q.x * p.y;
  }
  Points points;
  for (const auto& [side, part] : FindEvenPlaces(contour, kStep, 8, 2000))
    points.at.push_back(contour[side] + part * (contour[(side + 1) % n] - contour[side]));
  const std::size_t count = points.at.size();
  if (area < 0) std::reverse(points.at.begin(), points.at.end());
  constexpr std::size_t kReach = 2;  // over which the normal is taken
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 along = points.at[(k + kReach) % count] - points.at[(k + count - kReach) % count];
    const double norm = Norm(along);
    points.normal.push_back(norm > 0 ? Vec2{along.y / norm, -along.x / norm} : Vec2{});
  }
  return points;
}

}  // namespace

std::vector<Vec2> ContourMatch::At(double part) const {
  std::vector<Vec2> contour;
  contour.reserve(pairs.size());
  for (const auto& pair : pairs) contour.push_back(pair[0] + part * (pair[1] - pair[0]));
  return contour;
}

ContourMatch MatchContours(std::span<const Vec2> a, std::span<const Vec2> b) {
  TROCAR_ASSERT(a.size() >= 3 && b.size() >= 3);
  const Points from = Resample(a), to = Resample(b);
  const std::size_t n = from.at.size(), m = to.at.size();
  const auto cost = [&](std::size_t i, std::size_t j) {
    const Vec2 away = to.at[j % m] - from.at[i % n];
    return Dot(away, away) + kNormalWeight * (1.0 - Dot(from.normal[i % n], to.normal[j % m]));
  };
  // start where the contours agree best
  std::size_t i0 = 0, j0 = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      if (const double c = cost(i, j); c < least) least = c, i0 = i, j0 = j;
    }
  }
  // once around both
  enum Step : std::uint8_t { kBoth, kFirst, kSecond };
  std::vector<Step> steps((n + 1) * (m + 1), kBoth);
  std::vector<double> before(m + 1), now(m + 1);
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t j = 0; j <= m; ++j) {
      double best = i == 0 && j == 0 ? 0.0 : std::numeric_limits<double>::max();
      Step step = kBoth;
      if (i > 0 && j > 0 && before[j - 1] < best) best = before[j - 1], step = kBoth;
      if (i > 0 && before[j] < best) best = before[j], step = kFirst;
      if (j > 0 && now[j - 1] < best) best = now[j - 1], step = kSecond;
      now[j] = best + cost(i0 + i, j0 + j);
      steps[i * (m + 1) + j] = step;
    }
    std::swap(before, now);
  }
  ContourMatch match;
  for (std::size_t i = n, j = m; i > 0 || j > 0;) {
    match.pairs.push_back({from.at[(i0 + i) % n], to.at[(j0 + j) % m]});
    const Step step = steps[i * (m + 1) + j];
    if (step != kSecond) --i;
    if (step != kFirst) --j;
  }
  std::reverse(match.pairs.begin(), match.pairs.end());
  return match;
}

}  // namespace trocar::contours
