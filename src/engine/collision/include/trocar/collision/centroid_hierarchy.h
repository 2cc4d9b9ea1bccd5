// SPDX-License-Identifier: Apache-2.0
/// \file centroid_hierarchy.h  Which triangle of a deforming organ is nearest: the paper's tree of triangle
/// centroids.
///
/// The tree is built by farthest-pair splits and searched in two ways. FindGreedy is the paper's descent
/// without a way back: quick, and often not the nearest triangle. FindNearest is a branch and bound over the
/// same tree with a box in every node: always the nearest. What runs in the simulator is FindNearest.
///
/// Departures from the paper, each with its reason:
/// - "Centroid" is the intersection of the medians (section 3.3.4); section 3.3.1 describes the incentre
/// instead.
/// - Section 3.3.3 prints "If d(T, C_1) > d(T, C_2) then U_k", which taken as C_1 = C_k descends to the
/// farther child.
///   Here C_1 = C_j and C_2 = C_k, which is also the rule of the build.
/// - Groups of coinciding centroids are halved by index, and below kMaxFarthestPairDepth groups are halved
/// along their
///   longest axis, so that no input makes the tree deeper than kMaxHierarchyDepth. Organs stay far above that
///   limit.
/// Source: "General algorithms for laparoscopic surgical simulators", section 3.3.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::collision {

/// In place of a triangle's index: there is none.
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;
/// Nodes of this depth and above are split by the paper's rule [-].
inline constexpr int kMaxFarthestPairDepth = 64;
/// No leaf lies deeper: halving 2^32 triangles takes 32 more levels [-].
inline constexpr int kMaxHierarchyDepth = kMaxFarthestPairDepth + 33;

/// Centroid of a triangle, the mean of its corners [m].
inline math::Vec3 CalcCentroid(std::span<const math::Vec3> positions, const geometry::Triangle& triangle) {
  return (positions[triangle[0]] + positions[triangle[1]] + positions[triangle[2]]) / 3.0;
}

/// One group of triangles. Parents stand before their children, so a reverse sweep over the nodes runs
/// bottom-up.
struct HierarchyNode {
  std::uint32_t first_child = 0;  ///< U_k; U_j is first_child + 1. 0 in a leaf
  std::uint32_t parent = 0;       ///< 0 in the root too
  std::uint32_t triangle_k = 0;   ///< C_k, the centroid that stands for U_k; in a leaf its triangle
  std::uint32_t triangle_j = 0;   ///< C_j, the centroid that stands for U_j; in a leaf its triangle

  bool IsLeaf() const { return first_child == 0; }
};

/// Answer of a search.
struct NearestTriangle {
  std::uint32_t triangle = kNoTriangle;
  math::Vec3 point;                           ///< nearest point of the triangle [m]
  std::array<double, 3> weights = {0, 0, 0};  ///< its barycentric weights, >= 0, sum 1
  double squared_distance = std::numeric_limits<double>::infinity();  ///< [m^2]

  bool Found() const { return triangle != kNoTriangle; }
};

/// Bound and starting triangle of a search.
struct SearchLimits {
  double max_distance = std::numeric_limits<double>::infinity();  ///< farther triangles are not found [m]
  /// Triangle to start from, for example the last tick's; it changes the time and never the answer.
  std::uint32_t first_guess = kNoTriangle;
};

/// The paper's hierarchy over the triangles of one mesh whose vertices move and whose triangles stay.
///
/// Positions are the caller's: every call gets them. A search must get those of the last update.
class CentroidHierarchy {
 public:
  /// Holds no triangle; every search finds none.
  CentroidHierarchy() = default;

  /// Builds the tree; triangles are copied.
  ///
  /// \param positions  (nv) [m]
  /// \param triangles  (nt)
  /// \return kMeshInvalid for no triangle, an index out of range or a coordinate that is not finite
  /// \note Not real-time safe: allocates.
  static base::Result<CentroidHierarchy> Make(std::span<const math::Vec3> positions,
                                              std::span<const geometry::Triangle> triangles);

  /// Recomputes every centroid and refits every node from the leaves to the root.
  ///
  /// Groups and their two representative triangles stay; the representatives' centroids move with the mesh.
  /// \param positions  (nv) [m]
  /// \note Real-time safe: no allocation, lock or throw.
  void UpdateAll(std::span<const math::Vec3> positions) noexcept;

  /// UpdateAll() for modified triangles and the nodes above them alone (section 3.3.4). Repeated entries do no harm.
  /// \param modified  indices of triangles, each < Triangles().size() (TROCAR_ASSERT)
  /// \note Real-time safe: no allocation, lock or throw.
  void Update(std::span<const math::Vec3> positions, std::span<const std::uint32_t> modified) noexcept;

  /// The paper's search: from the root always to the child whose representative centroid is nearer
  /// (section 3.3.3).
  /// \return a triangle that is near and often not the nearest; kNoTriangle in an empty
  /// hierarchy
  /// \note Real-time safe: no allocation, lock or throw.
  std::uint32_t FindGreedy(const math::Vec3& p) const noexcept;

  /// The nearest triangle to p; of equally near ones that of lowest index.
  ///
  /// \param positions  (nv) as at the last update [m]
  /// \return not Found() when nothing lies within max_distance or p is not finite
  /// \note Real-time safe: no allocation, lock or throw.
  NearestTriangle FindNearest(std::span<const math::Vec3> positions, const math::Vec3& p,
                              const SearchLimits& limits = {}) const noexcept;

  std::span<const geometry::Triangle> Triangles() const noexcept { return triangles_; }
  std::span<const math::Vec3> Centroids() const noexcept { return centroids_; }  ///< (nt) [m]
  std::span<const HierarchyNode> Nodes() const noexcept { return nodes_; }       ///< (2 nt - 1), root first
  std::span<const geometry::Box> Boxes() const noexcept {
    return boxes_;
  }                                              ///< (2 nt - 1) around each node's triangles
  int Depth() const noexcept { return depth_; }  ///< edges from the root to the deepest leaf

 private:
  void RefitLeaf(std::span<const math::Vec3> positions, std::uint32_t triangle) noexcept;

  std::vector<geometry::Triangle> triangles_;
  std::vector<math::Vec3> centroids_;
  std::vector<HierarchyNode> nodes_;
  std::vector<geometry::Box> boxes_;
  std::vector<std::uint32_t> leaves_;   // (nt) node of each triangle
  std::vector<std::uint8_t> modified_;  // (2 nt - 1) all zero between calls
  int depth_ = 0;
};

}  // namespace trocar::collision
