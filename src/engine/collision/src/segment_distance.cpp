// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/segment_distance.h"

#include <algorithm>
#include <cmath>

#include "trocar/geometry/distance.h"

namespace trocar::collision {

using math::Dot;
using math::SquaredNorm;
using math::Vec3;

void FindNearestParameters(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1, double& s,
                           double& t) noexcept {
  const Vec3 d1 = p1 - p0, d2 = q1 - q0, r = p0 - q0;
  const double a = SquaredNorm(d1), e = SquaredNorm(d2), f = Dot(d2, r);
  s = t = 0.0;
  if (!(a > 0.0) && !(e > 0.0)) return;
  if (!(a > 0.0)) {
    t = std::clamp(f / e, 0.0, 1.0);
    return;
  }
  const double c = Dot(d1, r);
  if (!(e > 0.0)) {
    s = std::clamp(-c / a, 0.0, 1.0);
    return;
  }
  const double b = Dot(d1, d2), denominator = a * e - b * b;
  if (denominator > 0.0) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
  t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
}

SegmentSegmentPoints FindNearestSegmentSegment(const Segment& a, const Segment& b) noexcept {
  const auto at = [](const Segment& segment, double t) {
    return t >= 1.0 ? segment.end : segment.start + t * (segment.end - segment.start);
  };
  SegmentSegmentPoints best;
  bool is_first = true;
  const auto consider = [&](double s, double t) {
    const Vec3 on_a = at(a, s), on_b = at(b, t);
    const double d2 = math::SquaredDistance(on_a, on_b);
    if (!is_first && !(d2 < best.squared_distance)) return;
    best = {s, t, on_a, on_b, d2};
    is_first = false;
  };
  double s = 0.0, t = 0.0;
  FindNearestParameters(a.start, a.end, b.start, b.end, s, t);
  consider(s, t);
  consider(0.0, geometry::FindNearestOnSegment(a.start, b.start, b.end));
  consider(1.0, geometry::FindNearestOnSegment(a.end, b.start, b.end));
  consider(geometry::FindNearestOnSegment(b.start, a.start, a.end), 0.0);
  consider(geometry::FindNearestOnSegment(b.end, a.start, a.end), 1.0);
  return best;
}

CapsuleGap FindCapsuleGap(const Capsule& a, const Capsule& b) noexcept {
  CapsuleGap gap;
  gap.axes = FindNearestSegmentSegment(a.axis, b.axis);
  gap.distance = std::sqrt(gap.axes.squared_distance) - a.radius - b.radius;
  gap.normal = math::Normalized(gap.axes.on_b - gap.axes.on_a, {0, 0, 0});
  return gap;
}

}  // namespace trocar::collision
