// SPDX-License-Identifier: Apache-2.0
#include "trocar/collision/centroid_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "branch_and_bound.h"
#include "trocar/base/assert.h"
#include "trocar/collision/farthest_pair.h"

namespace trocar::collision {

using geometry::Box;
using geometry::Triangle;
using math::Vec3;

namespace {

/// Boxes reach this much beyond their corners, as a part of the largest coordinate: a point interpolated
/// between the corners may round to just outside of them.
constexpr double kBoxMargin = 16.0 * std::numeric_limits<double>::epsilon();

/// The longest axis of the members' box: 0, 1 or 2.
int FindLongestAxis(std::span<const Vec3> centroids, std::span<const std::uint32_t> members) {
  Box box{centroids[members[0]], centroids[members[0]]};
  for (const std::uint32_t member : members) {
    box.min = math::Min(box.min, centroids[member]);
    box.max = math::Max(box.max, centroids[member]);
  }
  const Vec3 size = box.max - box.min;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Divides members (ascending) into U_k, placed first, and U_j; both stay ascending.
/// \return the size of U_k, and the two representatives
struct Division {
  std::size_t size_k;
  std::uint32_t triangle_k, triangle_j;
};

Division Divide(std::span<const Vec3> centroids, std::span<std::uint32_t> members, int depth) {
  if (depth >= kMaxFarthestPairDepth) {
    const int axis = FindLongestAxis(centroids, members);
    const std::size_t half = members.size() / 2;
    std::stable_sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
      return centroids[a][axis] < centroids[b][axis];
    });
    const std::uint32_t low = members.front(), high = members.back();
    std::sort(members.begin(), members.begin() + half);
    std::sort(members.begin() + half, members.end());
    return {half, low, high};
  }
  const FarthestPair pair = FindFarthestPair(centroids, members);
  if (!(pair.squared_distance > 0.0)) {
    const std::size_t half = members.size() / 2;
    return {half, members[0], members[half]};
  }
  const Vec3 &c_k = centroids[pair.first], &c_j = centroids[pair.second];
  const auto belongs_to_k = [&](std::uint32_t i) {
    if (i == pair.first) return true;
    if (i == pair.second) return false;
    return math::SquaredDistance(c_j, centroids[i]) > math::SquaredDistance(c_k, centroids[i]);
  };
  const auto begin_j = std::stable_partition(members.begin(), members.end(), belongs_to_k);
  return {static_cast<std::size_t>(begin_j - members.begin()), pair.first, pair.second};
}

base::Status CheckInput(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  const auto fail = [](std::string text) {
    return base::Error{base::ErrorCode::kMeshInvalid, std::move(text)};
  };
  if (triangles.empty())
    return fail("a collision hierarchy needs at least one triangle: check the organ's mesh");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t vertex : triangles[t]) {
      if (vertex >= positions.size()) {
        return fail("triangle " + std::to_string(t) + " names vertex " + std::to_string(vertex) + " of " +
                    std::to_string(positions.size()) + ": check the organ's mesh");
      }
      if (!math::IsFinite(positions[vertex])) {
        return fail("vertex " + std::to_string(vertex) +
                    " has a coordinate that is not finite: check the organ's mesh");
      }
    }
  }
  return {};
}

}  // namespace

base::Result<CentroidHierarchy> CentroidHierarchy::Make(std::span<const Vec3> positions,
                                                        std::span<const Triangle> triangles) {
  if (base::Status status = CheckInput(positions, triangles); !status.ok()) return status.error();
  CentroidHierarchy hierarchy;
  const std::size_t count = triangles.size();
  hierarchy.triangles_.assign(triangles.begin(), triangles.end());
  hierarchy.centroids_.reserve(count);
  for (const Triangle& triangle : triangles)
    hierarchy.centroids_.push_back(CalcCentroid(positions, triangle));
  hierarchy.leaves_.resize(count);
  hierarchy.nodes_.reserve(2 * count - 1);

  // groups wait in a list instead of on the call stack, so that no depth of the tree overflows it
  struct Group {
    std::uint32_t begin, end, node;
    int depth;
  };
  std::vector<std::uint32_t> order(count);
  for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
  hierarchy.nodes_.push_back({});
  std::vector<Group> groups{{0, static_cast<std::uint32_t>(count), 0, 0}};
  while (!groups.empty()) {
    const Group group = groups.back();
    groups.pop_back();
    hierarchy.depth_ = std::max(hierarchy.depth_, group.depth);
    HierarchyNode& node = hierarchy.nodes_[group.node];
    if (group.end - group.begin == 1) {
      node.triangle_k = node.triangle_j = order[group.begin];
      hierarchy.leaves_[order[group.begin]] = group.node;
      continue;
    }
    const Division division = Divide(
        hierarchy.centroids_, std::span(order).subspan(group.begin, group.end - group.begin), group.depth);
    const auto first_child = static_cast<std::uint32_t>(hierarchy.nodes_.size());
    node.first_child = first_child;
    node.triangle_k = division.triangle_k;
    node.triangle_j = division.triangle_j;
    hierarchy.nodes_.push_back({0, group.node, 0, 0});
    hierarchy.nodes_.push_back({0, group.node, 0, 0});
    const std::uint32_t middle = group.begin + static_cast<std::uint32_t>(division.size_k);
    groups.push_back({middle, group.end, first_child + 1, group.depth + 1});
    groups.push_back({group.begin, middle, first_child, group.depth + 1});
  }
  TROCAR_ASSERT(hierarchy.depth_ <= kMaxHierarchyDepth);
  hierarchy.boxes_.resize(hierarchy.nodes_.size());
  hierarchy.modified_.assign(hierarchy.nodes_.size(), 0);
  hierarchy.UpdateAll(positions);
  return hierarchy;
}

void CentroidHierarchy::RefitLeaf(std::span<const Vec3> positions, std::uint32_t triangle) noexcept {
  const Triangle& corners = triangles_[triangle];
  const Vec3 &a = positions[corners[0]], &b = positions[corners[1]], &c = positions[corners[2]];
  centroids_[triangle] = (a + b + c) / 3.0;
  const auto fit = [](double x, double y, double z, double& low, double& high) {
    low = std::min(std::min(x, y), z);
    high = std::max(std::max(x, y), z);
    const double margin = kBoxMargin * std::max(std::fabs(low), std::fabs(high));
    low -= margin;
    high += margin;
  };
  Box& box = boxes_[leaves_[triangle]];
  fit(a.x, b.x, c.x, box.min.x, box.max.x);
  fit(a.y, b.y, c.y, box.min.y, box.max.y);
  fit(a.z, b.z, c.z, box.min.z, box.max.z);
}

namespace {

void Unite(const Box& a, const Box& b, Box& box) {
  box.min = {std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y), std::min(a.min.z, b.min.z)};
  box.max = {std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y), std::max(a.max.z, b.max.z)};
}

}  // namespace

void CentroidHierarchy::UpdateAll(std::span<const Vec3> positions) noexcept {
  for (std::uint32_t triangle = 0; triangle < triangles_.size(); ++triangle) RefitLeaf(positions, triangle);
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const std::uint32_t child = nodes_[i].first_child;
    if (child != 0) Unite(boxes_[child], boxes_[child + 1], boxes_[i]);
  }
}

void CentroidHierarchy::Update(std::span<const Vec3> positions,
                               std::span<const std::uint32_t> modified) noexcept {
  std::uint32_t last = 0;
  for (const std::uint32_t triangle : modified) {
    TROCAR_ASSERT(triangle < triangles_.size());
    RefitLeaf(positions, triangle);
    // mark the way up, as far as it is not marked yet
    for (std::uint32_t node = leaves_[triangle]; node != 0;) {
      node = nodes_[node].parent;
      if (modified_[node] != 0) break;
      modified_[node] = 1;
      last = std::max(last, node);
    }
  }
  for (std::uint32_t i = last + 1; i-- > 0;) {
    if (modified_.empty() || modified_[i] == 0) continue;
    modified_[i] = 0;
    const std::uint32_t child = nodes_[i].first_child;
    Unite(boxes_[child], boxes_[child + 1], boxes_[i]);
  }
}

std::uint32_t CentroidHierarchy::FindGreedy(const Vec3& p) const noexcept {
  if (nodes_.empty()) return kNoTriangle;
  std::uint32_t node = 0;
  while (!nodes_[node].IsLeaf()) {
    const double to_k = math::SquaredDistance(p, centroids_[nodes_[node].triangle_k]);
    const double to_j = math::SquaredDistance(p, centroids_[nodes_[node].triangle_j]);
    node = nodes_[node].first_child + (to_j > to_k ? 0 : 1);
  }
  return nodes_[node].triangle_k;
}

NearestTriangle CentroidHierarchy::FindNearest(std::span<const Vec3> positions, const Vec3& p,
                                               const SearchLimits& limits) const noexcept {
  if (!math::IsFinite(p)) return {};
  NearestTriangle best = StartSearch(limits.max_distance);
  const auto visit = [&](std::uint32_t triangle) {
    ConsiderForPoint(positions, triangles_[triangle], triangle, p, best);
  };
  if (limits.first_guess < triangles_.size()) visit(limits.first_guess);
  SearchNearestFirst(
      *this, best.squared_distance,
      [&p](const Box& box) {
        const double dx = std::max(0.0, std::max(box.min.x - p.x, p.x - box.max.x));
        const double dy = std::max(0.0, std::max(box.min.y - p.y, p.y - box.max.y));
        const double dz = std::max(0.0, std::max(box.min.z - p.z, p.z - box.max.z));
        return dx * dx + dy * dy + dz * dz;
      },
      visit);
  return EndSearch(best);
}

}  // namespace trocar::collision
