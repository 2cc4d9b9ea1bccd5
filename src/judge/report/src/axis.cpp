// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/axis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"

namespace trocar::report {

using math::Vec2;

std::vector<double> FindAxisMarks(double low, double high, int wanted) {
  TROCAR_ASSERT(low < high && wanted >= 2);
  const double rough = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) {
      step = factor * power;
      break;
    }
  }
  std::vector<double> marks;
  for (double n = std::ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n += 1) {
    marks.push_back(n == 0 ? 0.0 : n * step);  // never -0
  }
  return marks;
}

std::vector<double> FindLogMarks(double low, double high) {
  TROCAR_ASSERT(0 < low && low < high);
  const bool is_short = std::log10(high / low) < 2.5;
  std::vector<double> marks;
  for (double n = std::floor(std::log10(low)); n <= std::log10(high) + 1e-9; n += 1) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double mark = factor * std::pow(10.0, n);
      if ((factor == 1.0 || is_short) && mark >= low * (1 - 1e-9) && mark <= high * (1 + 1e-9))
        marks.push_back(mark);
    }
  }
  return marks;
}

std::vector<Vec2> ThinOut(const std::vector<Vec2>& points, std::size_t limit) {
  TROCAR_ASSERT(limit >= 2);
  if (points.size() <= limit) return points;
  std::vector<Vec2> kept;
  const std::size_t stretches = limit / 2;
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(s * points.size() / stretches);
    const auto last = points.begin() + static_cast<std::ptrdiff_t>((s + 1) * points.size() / stretches);
    const auto [low, high] =
        std::minmax_element(first, last, [](const Vec2& a, const Vec2& b) { return a.y < b.y; });
    kept.push_back(*std::min(low, high));
    if (low != high) kept.push_back(*std::max(low, high));
  }
  return kept;
}

std::vector<double> FindTimeMarks(double seconds, int wanted) {
  TROCAR_ASSERT(seconds > 0 && wanted >= 2);
  double step = 1800;
  for (const double candidate :
       {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0}) {
    if (candidate * wanted >= seconds) {
      step = candidate;
      break;
    }
  }
  std::vector<double> marks;
  for (double n = 0; n * step <= seconds * (1 + 1e-9); n += 1) marks.push_back(n * step);
  return marks;
}

}  // namespace trocar::report
