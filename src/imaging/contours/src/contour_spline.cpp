// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/contour_spline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/cubic_spline.h"

namespace trocar::contours {

using math::Vec2;

namespace {

/// Rounds of division; each at least halves the offending chords, so the curve ends at the polygon.
constexpr int kMaxRounds = 12;
/// Bulges below this are invisible and divide nothing [pixels].
constexpr double kHarmlessBulge = 0.5;

double Side(const Vec2& a, const Vec2& b, const Vec2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

bool IsBetween(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
         p.y <= std::max(a.y, b.y);
}

bool Touch(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double abc = Side(a, b, c), abd = Side(a, b, d), cda = Side(c, d, a), cdb = Side(c, d, b);
  if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0)))
    return true;
  return (abc == 0 && IsBetween(a, b, c)) || (abd == 0 && IsBetween(a, b, d)) ||
         (cda == 0 && IsBetween(c, d, a)) || (cdb == 0 && IsBetween(c, d, b));
}

/// Rectangle around a run of sides.
struct Box {
  double min_x = std::numeric_limits<double>::max(), max_x = std::numeric_limits<double>::lowest();
  double min_y = min_x, max_y = max_x;

  void Include(const Vec2& p) {
    min_x = std::min(min_x, p.x), max_x = std::max(max_x, p.x);
    min_y = std::min(min_y, p.y), max_y = std::max(max_y, p.y);
  }
  bool IsApartFrom(const Box& b) const {
    return b.max_x < min_x || b.min_x > max_x || b.max_y < min_y || b.min_y > max_y;
  }
};

/// Calls visit(i, j) for sides i < j that touch and are no neighbours. Runs of sides whose boxes lie apart
/// are passed over.
template <typename Visit>
void VisitCrossings(std::span<const Vec2> polygon, Visit visit) {
  const std::size_t n = polygon.size();
  constexpr std::size_t kRun = 16;
  std::vector<Box> boxes((n + kRun - 1) / kRun);
  for (std::size_t i = 0; i < n; ++i) {
    boxes[i / kRun].Include(polygon[i]);
    boxes[i / kRun].Include(polygon[(i + 1) % n]);
  }
  for (std::size_t i = 0; i + 2 < n; ++i) {
    const Vec2 &a = polygon[i], &b = polygon[i + 1];
    Box side;
    side.Include(a), side.Include(b);
    for (std::size_t j = i + 2; j < n; ++j) {
      if (side.IsApartFrom(boxes[j / kRun])) {
        j = (j / kRun + 1) * kRun - 1;
        continue;
      }
      if (i == 0 && j == n - 1) continue;
      const Vec2 &c = polygon[j], &d = polygon[(j + 1) % n];
      if (std::max(c.x, d.x) < side.min_x || std::min(c.x, d.x) > side.max_x) continue;
      if (std::max(c.y, d.y) < side.min_y || std::min(c.y, d.y) > side.max_y) continue;
      if (Touch(a, b, c, d) && !visit(i, j)) return;
    }
  }
}

struct Sampled {
  std::vector<Vec2> points;
  std::vector<std::size_t> segment;  // of each point: the control point it follows
};

Sampled SampleSpline(const math::CubicSpline& spline, double step) {
  Sampled sampled;
  const auto knots = spline.Knots();
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double length = knots[i + 1] - knots[i];
    const int count = std::max(2, base::CeilTo<int>(length / step));
    for (int k = 0; k < count; ++k) {
      const auto p = spline.Evaluate(knots[i] + length * k / count);
      sampled.points.push_back({p.x, p.y});
      sampled.segment.push_back(i);
    }
  }
  return sampled;
}

}  // namespace

bool CrossesItself(std::span<const Vec2> polygon) {
  bool crosses = false;
  VisitCrossings(polygon, [&](std::size_t, std::size_t) {
    crosses = true;
    return false;
  });
  return crosses;
}

std::vector<Vec2> FitContour(std::span<const Vec2> points, const ContourSplineSettings& settings) {
  return FitContourCurve(points, settings).points;
}

ContourCurve FitContourCurve(std::span<const Vec2> points, const ContourSplineSettings& settings) {
  TROCAR_ASSERT(points.size() >= 3);
  std::vector<math::Vec3> controls;
  std::vector<std::size_t> given;  // point that each control is or follows
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2& p = points[i];
    if (controls.empty() || controls.back().x != p.x || controls.back().y != p.y) {
      controls.push_back({p.x, p.y, 0.0});
      given.push_back(i);
    }
  }
  while (controls.size() > 1 && controls.back() == controls.front()) controls.pop_back(), given.pop_back();
  const bool polygon_crosses = CrossesItself(points);

  ContourCurve curve;
  std::set<std::size_t> divided;
  for (int round = 0;; ++round) {
    const math::CubicSpline spline(controls, math::SplineEnds::kClosed);
    Sampled sampled = SampleSpline(spline, settings.step_px);
    // segments that swing out too far
    std::set<std::size_t> irregular;
    const std::size_t n = controls.size();
    for (std::size_t k = 0; k < sampled.points.size(); ++k) {
      const std::size_t i = sampled.segment[k];
      const Vec2 a{controls[i].x, controls[i].y}, b{controls[(i + 1) % n].x, controls[(i + 1) % n].y};
      const Vec2 chord = b - a;
      const double length = Norm(chord);
      const double t = std::clamp(Dot(sampled.points[k] - a, chord) / (length * length), 0.0, 1.0);
      const double away = Norm(sampled.points[k] - (a + t * chord));
      if (away > kHarmlessBulge && away > settings.max_bulge * length) irregular.insert(i);
    }
    // segments that cross each other
    if (!polygon_crosses) {
      VisitCrossings(sampled.points, [&](std::size_t a, std::size_t b) {
        irregular.insert(sampled.segment[a]);
        irregular.insert(sampled.segment[b]);
        return true;
      });
    }
    for (const std::size_t i : irregular) divided.insert(given[i]);
    curve.divided.assign(divided.begin(), divided.end());
    if (irregular.empty()) {
      curve.points = std::move(sampled.points);
      for (const std::size_t i : sampled.segment) curve.segment.push_back(given[i]);
      return curve;
    }
    if (round == kMaxRounds) break;

    std::vector<math::Vec3> denser;
    std::vector<std::size_t> denser_given;
    for (std::size_t i = 0; i < n; ++i) {
      denser.push_back(controls[i]), denser_given.push_back(given[i]);
      if (!irregular.contains(i)) continue;
      denser.push_back(0.5 * (controls[i] + controls[(i + 1) % n])), denser_given.push_back(given[i]);
    }
    controls = std::move(denser), given = std::move(denser_given);
  }
  // the polygon itself is the limit of division
  curve.points.assign(points.begin(), points.end());
  for (std::size_t i = 0; i < points.size(); ++i) curve.segment.push_back(i);
  return curve;
}

}  // namespace trocar::contours
