// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/queries.h"

#include <algorithm>
#include <cmath>

#include "branch_and_bound.h"
#include "ray_crossing.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/elementary.h"

namespace trocar::collision {

using geometry::Triangle;
using math::Dot;
using math::Vec3;

namespace {

/// Lower bounds give this part of the largest coordinate away, so that rounding never excludes the nearest
/// triangle.
constexpr double kBoundMargin = 64.0 * std::numeric_limits<double>::epsilon();

double LargestCoordinate(const Vec3& a) {
  return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
}

/// No point of a box is nearer to the segment than this: the gap between its box and the segment's, or the
/// gap between its sphere and the segment, whichever is greater.
class SegmentBound {
 public:
  explicit SegmentBound(const Segment& segment)
      : segment_(segment),
        box_{math::Min(segment.start, segment.end), math::Max(segment.start, segment.end)},
        scale_(std::max(LargestCoordinate(segment.start), LargestCoordinate(segment.end))) {}

  /// [m^2]
  double operator()(const geometry::Box& box) const {
    const double margin =
        kBoundMargin * std::max({scale_, LargestCoordinate(box.min), LargestCoordinate(box.max)});
    const auto gap = [margin](double low, double high, double other_low, double other_high) {
      return std::max(0.0, std::max(low - other_high, other_low - high) - margin);
    };
    const double dx = gap(box.min.x, box.max.x, box_.min.x, box_.max.x);
    const double dy = gap(box.min.y, box.max.y, box_.min.y, box_.max.y);
    const double dz = gap(box.min.z, box.max.z, box_.min.z, box_.max.z);
    const Vec3 centre = 0.5 * (box.min + box.max);
    const double t = geometry::FindNearestOnSegment(centre, segment_.start, segment_.end);
    const double to_sphere = math::Distance(centre, segment_.start + t * (segment_.end - segment_.start)) -
                             0.5 * math::Distance(box.min, box.max) - margin;
    return std::max(dx * dx + dy * dy + dz * dz, to_sphere > 0.0 ? to_sphere * to_sphere : 0.0);
  }

 private:
  Segment segment_;
  geometry::Box box_;
  double scale_;
};

Vec3 UnitNormal(std::span<const Vec3> positions, const Triangle& triangle) {
  return math::Normalized(geometry::CalcAreaNormal(positions, triangle), {0, 0, 0});
}

/// Angle of a triangle at one of its vertices [rad]; 0 where a side has no length.
double CalcAngleAt(std::span<const Vec3> positions, const Triangle& triangle, std::uint32_t vertex) {
  const int i = triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
  const Vec3 &a = positions[triangle[i]], &b = positions[triangle[(i + 1) % 3]],
             &c = positions[triangle[(i + 2) % 3]];
  return math::Atan2(math::Norm(math::Cross(b - a, c - a)), Dot(b - a, c - a));
}

}  // namespace

SegmentContact FindNearestToSegment(const CentroidHierarchy& hierarchy, std::span<const Vec3> positions,
                                    const Segment& segment, const SearchLimits& limits) noexcept {
  SegmentContact best;
  if (!math::IsFinite(segment.start) || !math::IsFinite(segment.end)) return best;
  best.nearest = StartSearch(limits.max_distance);
  const auto visit = [&](std::uint32_t triangle) {
    ConsiderForSegment(positions, hierarchy.Triangles()[triangle], triangle, segment, best);
  };
  if (limits.first_guess < hierarchy.Triangles().size()) visit(limits.first_guess);
  SearchNearestFirst(hierarchy, best.nearest.squared_distance, SegmentBound(segment), visit);
  best.nearest = EndSearch(best.nearest);
  return best;
}

CapsuleContact FindNearestToCapsule(const CentroidHierarchy& hierarchy, std::span<const Vec3> positions,
                                    const Capsule& capsule, const SearchLimits& limits) noexcept {
  SearchLimits axis_limits = limits;
  axis_limits.max_distance += capsule.radius;
  return MakeCapsuleContact(FindNearestToSegment(hierarchy, positions, capsule.axis, axis_limits),
                            capsule.radius);
}

std::size_t FindTrianglesInCapsule(const CentroidHierarchy& hierarchy, std::span<const Vec3> positions,
                                   const Capsule& capsule, std::span<std::uint32_t> found) noexcept {
  if (!math::IsFinite(capsule.axis.start) || !math::IsFinite(capsule.axis.end) || !(capsule.radius >= 0.0))
    return 0;
  const double limit = capsule.radius * capsule.radius;
  std::size_t count = 0;
  SearchNearestFirst(hierarchy, limit, SegmentBound(capsule.axis), [&](std::uint32_t triangle) {
    const Triangle& corners = hierarchy.Triangles()[triangle];
    const SegmentTrianglePoints points =
        FindNearestSegmentTriangle(capsule.axis.start, capsule.axis.end, positions[corners[0]],
                                   positions[corners[1]], positions[corners[2]]);
    if (!(points.squared_distance <= limit)) return;
    if (count < found.size()) found[count] = triangle;
    ++count;
  });
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(std::min(count, found.size())));
  return count;
}

SurfaceSide FindSide(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                     const geometry::Rows& vertex_triangles, const Vec3& p,
                     const NearestTriangle& nearest) noexcept {
  TROCAR_ASSERT(nearest.Found());
  const Triangle& corners = triangles[nearest.triangle];
  // corners that take part in the nearest point
  std::uint32_t parts[3] = {0, 0, 0};
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    if (nearest.weights[i] > 0.0) parts[count++] = corners[i];
  }

  SurfaceSide side;
  Vec3 normal;
  if (count == 1) {
    side.feature = SurfaceFeature::kVertex;
    for (const std::uint32_t t : vertex_triangles.Row(parts[0])) {
      normal += CalcAngleAt(positions, triangles[t], parts[0]) * UnitNormal(positions, triangles[t]);
    }
  } else if (count == 2) {
    side.feature = SurfaceFeature::kEdge;
    for (const std::uint32_t t : vertex_triangles.Row(parts[0])) {
      if (std::find(triangles[t].begin(), triangles[t].end(), parts[1]) == triangles[t].end()) continue;
      normal += UnitNormal(positions, triangles[t]);
    }
  } else {
    normal = UnitNormal(positions, corners);
  }
  side.normal = math::Normalized(normal, {0, 0, 0});
  const double distance = std::sqrt(nearest.squared_distance);
  side.distance = Dot(p - nearest.point, side.normal) < 0.0 ? -distance : distance;
  return side;
}

bool IsInside(std::span<const Vec3> positions, std::span<const Triangle> triangles, const Vec3& p) noexcept {
  return DoMostRaysLeave([&](int axis) {
    int count = 0;
    for (const Triangle& t : triangles) count += CountLeaving(positions, t, p, axis);
    return count;
  });
}

}  // namespace trocar::collision
