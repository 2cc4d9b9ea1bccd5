// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "branch_and_bound.h"
#include "ray_crossing.h"
#include "trocar/base/assert.h"
#include "wide_search.h"

namespace trocar::collision {

using geometry::Triangle;
using math::Vec3;

namespace {

base::Status CheckMesh(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  const auto fail = [](std::string text) {
    return base::Error{base::ErrorCode::kMeshInvalid, std::move(text) + ": check the organ's mesh"};
  };
  if (triangles.empty()) return fail("a collision tree needs at least one triangle");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t vertex : triangles[t]) {
      if (vertex < positions.size()) continue;
      return fail("triangle " + std::to_string(t) + " names vertex " + std::to_string(vertex) + " of " +
                  std::to_string(positions.size()));
    }
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3& p = positions[i];
    const bool is_good = std::fabs(p.x) <= kLargestCoordinate && std::fabs(p.y) <= kLargestCoordinate &&
                         std::fabs(p.z) <= kLargestCoordinate;
    if (!is_good)
      return fail("vertex " + std::to_string(i) + " has a coordinate that is not finite or too large");
  }
  return {};
}

/// How far beside a ray a triangle is looked at all the same [m^2]: rounding does not reach so far.
constexpr double kBesideRay2 = 1e-12;

}  // namespace

base::Result<TriangleTree> TriangleTree::Make(std::span<const Vec3> positions,
                                              std::span<const Triangle> triangles, base::SimdLevel simd) {
  TROCAR_ASSERT(base::HasSimdLevel(simd));
  TriangleTree made;
  made.tree_.simd = simd;
  if (base::Status built = made.Rebuild(positions, triangles); !built.ok()) return built.error();
  return made;
}

base::Status TriangleTree::Rebuild(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  if (base::Status checked = CheckMesh(positions, triangles); !checked.ok()) return checked;
  triangles_.assign(triangles.begin(), triangles.end());
  BuildWideTree(positions, triangles_, {}, tree_);
  return {};
}

void TriangleTree::Update(std::span<const Vec3> positions) noexcept {
  RefitWideTree(positions, tree_);
}

NearestTriangle TriangleTree::FindNearest(std::span<const Vec3> positions, const Vec3& p,
                                          const SearchLimits& limits) const noexcept {
  if (!math::IsFinite(p)) return {};
  NearestTriangle best = StartSearch(limits.max_distance);
  const auto visit = [&](std::uint32_t triangle) {
    ConsiderForPoint(positions, triangles_[triangle], triangle, p, best);
    return best.squared_distance;
  };
  if (limits.first_guess < triangles_.size()) visit(limits.first_guess);
  SearchWideTree(tree_, {p, p}, best.squared_distance, visit);
  return EndSearch(best);
}

SegmentContact TriangleTree::FindNearestToSegment(std::span<const Vec3> positions, const Segment& segment,
                                                  const SearchLimits& limits) const noexcept {
  SegmentContact best;
  if (!math::IsFinite(segment.start) || !math::IsFinite(segment.end)) return best;
  best.nearest = StartSearch(limits.max_distance);
  const auto visit = [&](std::uint32_t triangle) {
    ConsiderForSegment(positions, triangles_[triangle], triangle, segment, best);
    return best.nearest.squared_distance;
  };
  if (limits.first_guess < triangles_.size()) visit(limits.first_guess);
  SearchWideTree(tree_, segment, best.nearest.squared_distance, visit);
  best.nearest = EndSearch(best.nearest);
  return best;
}

CapsuleContact TriangleTree::FindNearestToCapsule(std::span<const Vec3> positions, const Capsule& capsule,
                                                  const SearchLimits& limits) const noexcept {
  SearchLimits axis_limits = limits;
  axis_limits.max_distance += capsule.radius;
  return MakeCapsuleContact(FindNearestToSegment(positions, capsule.axis, axis_limits), capsule.radius);
}

std::size_t TriangleTree::FindWithin(std::span<const Vec3> positions, const Capsule& capsule,
                                     std::span<std::uint32_t> found) const noexcept {
  const Segment& axis = capsule.axis;
  if (!math::IsFinite(axis.start) || !math::IsFinite(axis.end) || !(capsule.radius >= 0.0)) return 0;
  const double limit = capsule.radius * capsule.radius;
  std::size_t count = 0;
  SearchWideTree(tree_, axis, limit, [&](std::uint32_t triangle) {
    const auto& [a, b, c] = triangles_[triangle];
    const SegmentTrianglePoints points =
        FindNearestSegmentTriangle(axis.start, axis.end, positions[a], positions[b], positions[c]);
    if (points.squared_distance <= limit) {
      if (count < found.size()) found[count] = triangle;
      ++count;
    }
    return limit;
  });
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(std::min(count, found.size())));
  return count;
}

bool TriangleTree::IsInside(std::span<const Vec3> positions, const Vec3& p) const noexcept {
  if (tree_.nodes.empty() || !math::IsFinite(p)) return false;
  return DoMostRaysLeave([&](int axis) {
    const auto& ends = tree_.nodes.front().high[axis];
    const double end = static_cast<double>(*std::max_element(std::begin(ends), std::end(ends)));
    if (p[axis] > end) return 0;
    Vec3 last = p;
    last[axis] = end;
    int count = 0;
    SearchWideTree(tree_, {p, last}, kBesideRay2, [&](std::uint32_t triangle) {
      count += CountLeaving(positions, triangles_[triangle], p, axis);
      return kBesideRay2;
    });
    return count;
  });
}

}  // namespace trocar::collision
