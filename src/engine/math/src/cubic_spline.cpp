// SPDX-License-Identifier: Apache-2.0
#include "trocar/math/cubic_spline.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"

namespace trocar::math {
namespace {

/// Neighbours closer than this fraction of the largest coordinate extent count as one point.
constexpr double kMergeFraction = 1e-9;

std::vector<Vec3> MergeCoinciding(std::span<const Vec3> points, SplineEnds ends) {
  Vec3 low = points.front(), high = points.front();
  for (const Vec3& p : points) low = Min(low, p), high = Max(high, p);
  const double apart = kMergeFraction * Norm(high - low);
  std::vector<Vec3> kept;
  for (const Vec3& p : points) {
    if (kept.empty() || Distance(kept.back(), p) > apart) kept.push_back(p);
  }
  if (ends == SplineEnds::kClosed) {
    while (kept.size() > 1 && Distance(kept.back(), kept.front()) <= apart) kept.pop_back();
  }
  return kept;
}

/// Solves a tridiagonal system with diagonal `b`, off-diagonals `a` (below) and `c` (above) by Thomas'
/// algorithm.
template <typename Value>
std::vector<Value> SolveTridiagonal(const std::vector<double>& a, std::vector<double> b,
                                    const std::vector<double>& c, std::vector<Value> d) {
  const std::size_t n = b.size();
  for (std::size_t i = 1; i < n; ++i) {
    const double w = a[i] / b[i - 1];
    b[i] -= w * c[i - 1];
    d[i] -= w * d[i - 1];
  }
  d[n - 1] = d[n - 1] / b[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) d[i] = (d[i] - c[i] * d[i + 1]) / b[i];
  return d;
}

}  // namespace

CubicSpline::CubicSpline(std::span<const Vec3> points, SplineEnds ends) : ends_(ends) {
  points_ = MergeCoinciding(points, ends);
  TROCAR_ASSERT(points_.size() >= (ends == SplineEnds::kClosed ? 3u : 2u));
  const std::size_t distinct = points_.size();
  if (ends == SplineEnds::kClosed) points_.push_back(points_.front());

  knots_.assign(1, 0.0);
  for (std::size_t i = 1; i < points_.size(); ++i)
    knots_.push_back(knots_.back() + Distance(points_[i], points_[i - 1]));

  const auto step = [&](std::size_t i) { return knots_[i + 1] - knots_[i]; };
  const auto slope = [&](std::size_t i) { return (points_[i + 1] - points_[i]) / step(i); };
  curvatures_.assign(points_.size(), Vec3{});
  if (ends == SplineEnds::kNatural) {
    const std::size_t inner = distinct - 2;
    if (inner == 0) return;
    std::vector<double> a(inner), b(inner), c(inner);
    std::vector<Vec3> d(inner);
    for (std::size_t i = 0; i < inner; ++i) {
      a[i] = step(i), b[i] = 2.0 * (step(i) + step(i + 1)), c[i] = step(i + 1);
      d[i] = 6.0 * (slope(i + 1) - slope(i));
    }
    const auto solved = SolveTridiagonal(a, b, c, d);
    std::copy(solved.begin(), solved.end(), curvatures_.begin() + 1);
    return;
  }

  // periodic: tridiagonal plus two corners, by the Sherman-Morrison formula
  const std::size_t n = distinct;
  std::vector<double> a(n), b(n), c(n), u(n, 0.0);
  std::vector<Vec3> d(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = (i + n - 1) % n;
    a[i] = step(before), b[i] = 2.0 * (step(before) + step(i)), c[i] = step(i);
    d[i] = 6.0 * (slope(i) - slope(before));
  }
  const double corner_high = a[0], corner_low = c[n - 1];
  const double gamma = -b[0];
  b[0] -= gamma;
  b[n - 1] -= corner_high * corner_low / gamma;
  u[0] = gamma, u[n - 1] = corner_low;
  const auto y = SolveTridiagonal(a, b, c, d);
  const auto q = SolveTridiagonal(a, b, c, u);
  const double ratio = corner_high / gamma;
  const Vec3 factor = (y[0] + ratio * y[n - 1]) / (1.0 + q[0] + ratio * q[n - 1]);
  for (std::size_t i = 0; i < n; ++i) curvatures_[i] = y[i] - q[i] * factor;
  curvatures_[n] = curvatures_[0];
}

std::size_t CubicSpline::FindSegment(double s) const {
  const auto above = std::upper_bound(knots_.begin(), knots_.end(), s);
  const auto index = static_cast<std::size_t>(above - knots_.begin());
  return std::clamp<std::size_t>(index, 1, knots_.size() - 1) - 1;
}

Vec3 CubicSpline::Evaluate(double s) const {
  s = std::clamp(s, 0.0, Length());
  const std::size_t i = FindSegment(s);
  const double h = knots_[i + 1] - knots_[i];
  const double right = (s - knots_[i]) / h, left = 1.0 - right;
  return left * points_[i] + right * points_[i + 1] +
         (h * h / 6.0) * ((left * left * left - left) * curvatures_[i] +
                          (right * right * right - right) * curvatures_[i + 1]);
}

Vec3 CubicSpline::EvaluateDerivative(double s) const {
  s = std::clamp(s, 0.0, Length());
  const std::size_t i = FindSegment(s);
  const double h = knots_[i + 1] - knots_[i];
  const double right = (s - knots_[i]) / h, left = 1.0 - right;
  return (points_[i + 1] - points_[i]) / h + (h / 6.0) * ((1.0 - 3.0 * left * left) * curvatures_[i] +
                                                          (3.0 * right * right - 1.0) * curvatures_[i + 1]);
}

std::vector<Vec3> CubicSpline::Sample(int count) const {
  TROCAR_ASSERT(count >= 2);
  const int intervals = ends_ == SplineEnds::kClosed ? count : count - 1;
  std::vector<Vec3> samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) samples.push_back(Evaluate(Length() * i / intervals));
  return samples;
}

}  // namespace trocar::math
