// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/sweep.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace trocar::collision {

using math::Vec3;

namespace {

/// More than a hundred times what a straight approach takes.
constexpr int kMaxSteps = 256;

/// Earliest time from `time` on at which some pair of corners of the two bodies could be `reach` apart along
/// the unit direction n, which points from b to a; above 1 where none can.
double FindEarliest(std::span<const Vec3> a_from, std::span<const Vec3> a_to, std::span<const Vec3> b_from,
                    std::span<const Vec3> b_to, const Vec3& n, double reach, double time) noexcept {
  double earliest = 2.0;
  for (std::size_t i = 0; i < a_from.size(); ++i) {
    for (std::size_t j = 0; j < b_from.size(); ++j) {
      const double at_0 = math::Dot(n, a_from[i] - b_from[j]), at_1 = math::Dot(n, a_to[i] - b_to[j]);
      const double now = at_0 + time * (at_1 - at_0), closing = at_0 - at_1;
      if (!(closing > 0.0)) continue;
      earliest = std::min(earliest, time + std::max(0.0, now - reach) / closing);
    }
  }
  return earliest;
}

/// \param find_points    (time) -> nearest points
/// \param find_earliest  (direction from the body to the segment, time) -> FindEarliest
template <typename Points, typename FindPoints, typename Earliest>
Sweep<Points> Advance(double reach, const FindPoints& find_points, const Earliest& find_earliest) noexcept {
  Sweep<Points> sweep;
  double time = 0.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    Vec3 away;
    const Points points = find_points(time, away);
    const double distance = std::sqrt(points.squared_distance);
    if (!(distance > reach + kSweepTolerance)) return {true, time, points};
    // half of the tolerance is left to rounding in the products along the direction
    const double next = find_earliest(away / distance, time);
    if (next > 1.0) return {false, 1.0, find_points(1.0, away)};
    if (!(next > time)) return {true, time, points};
    time = next;
    sweep = {true, time, points};
  }
  Vec3 away;
  sweep.points = find_points(sweep.time, away);
  return sweep;
}

}  // namespace

TriangleSweep SweepToTriangle(const MovingSegment& segment, const MovingTriangle& triangle,
                              double reach) noexcept {
  const Vec3 from[2] = {segment.from.start, segment.from.end}, to[2] = {segment.to.start, segment.to.end};
  return Advance<SegmentTrianglePoints>(
      reach,
      [&](double time, Vec3& away) {
        const Segment at = segment.At(time);
        const std::array<Vec3, 3> corners = triangle.At(time);
        const SegmentTrianglePoints points =
            FindNearestSegmentTriangle(at.start, at.end, corners[0], corners[1], corners[2]);
        away = points.on_segment - points.on_triangle.point;
        return points;
      },
      [&](const Vec3& n, double time) {
        return FindEarliest(from, to, triangle.from, triangle.to, n, reach + 0.5 * kSweepTolerance, time);
      });
}

TubeSweep SweepToSegment(const MovingSegment& segment, const MovingSegment& axis, double reach) noexcept {
  const Vec3 from[2] = {segment.from.start, segment.from.end}, to[2] = {segment.to.start, segment.to.end};
  const Vec3 axis_from[2] = {axis.from.start, axis.from.end}, axis_to[2] = {axis.to.start, axis.to.end};
  return Advance<SegmentSegmentPoints>(
      reach,
      [&](double time, Vec3& away) {
        const SegmentSegmentPoints points = FindNearestSegmentSegment(segment.At(time), axis.At(time));
        away = points.on_a - points.on_b;
        return points;
      },
      [&](const Vec3& n, double time) {
        return FindEarliest(from, to, axis_from, axis_to, n, reach + 0.5 * kSweepTolerance, time);
      });
}

Capsule CalcSweptCapsule(const MovingSegment& segment, double radius) noexcept {
  // ends move along straight lines, so every point stays within half the longer way of the middle's
  const Segment middle = segment.At(0.5);
  const double way = std::max(math::Distance(segment.from.start, segment.to.start),
                              math::Distance(segment.from.end, segment.to.end));
  return {middle, radius + 0.5 * way};
}

}  // namespace trocar::collision
