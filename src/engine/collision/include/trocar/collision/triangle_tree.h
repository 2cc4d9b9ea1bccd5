// SPDX-License-Identifier: Apache-2.0
/// \file triangle_tree.h  Which triangle of a deforming organ is nearest, exactly: what runs in the simulator.
///
/// Boxes eight to a node, refitted every tick. CentroidHierarchy is the paper's own method and stays beside it
/// for comparison; both give the same answers, this one in less time (docs/contact.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/collision/queries.h"
#include "trocar/collision/wide_tree.h"

namespace trocar::collision {

/// No coordinate may be larger: single precision inside must not overflow [m].
inline constexpr double kLargestCoordinate = 1e15;

/// Exact searches over the triangles of one mesh whose vertices move.
///
/// Positions are the caller's: every call gets them. A search must get those of the last update or build.
/// Answers are those of the searches in brute_force.h, to the bit, on every instruction set.
class TriangleTree {
 public:
  /// Holds no triangle; every search finds none.
  TriangleTree() = default;

  /// \param positions  (nv) [m]
  /// \param triangles  (nt), copied
  /// \param simd       instruction set of the loops; changes no answer
  /// \return kMeshInvalid for no triangle, an index out of range or a coordinate that is not finite or too large
  /// \pre base::HasSimdLevel(simd) (TROCAR_ASSERT)
  /// \note Not real-time safe: allocates.
  static base::Result<TriangleTree> Make(std::span<const math::Vec3> positions,
                                         std::span<const geometry::Triangle> triangles,
                                         base::SimdLevel simd = base::FindSimdLevel());

  /// Rebuilds the tree in place for a mesh whose triangles have changed, as after a cut.
  ///
  /// \return kMeshInvalid as Make; then the tree is as before
  /// \note Allocates only where the mesh is larger than any before; well below 1 ms for 4,000 triangles.
  base::Status Rebuild(std::span<const math::Vec3> positions, std::span<const geometry::Triangle> triangles);

  /// Refits the tree to moved vertices.
  /// \param positions  (nv) finite, at most kLargestCoordinate [m]
  /// \note Real-time safe: no allocation, lock or throw.
  void Update(std::span<const math::Vec3> positions) noexcept;

  /// The nearest triangle to p; of equally near ones that of lowest index.
  /// \return not Found() when nothing lies within max_distance or p is not finite
  /// \note Real-time safe: no allocation, lock or throw.
  NearestTriangle FindNearest(std::span<const math::Vec3> positions, const math::Vec3& p,
                              const SearchLimits& limits = {}) const noexcept;

  /// The nearest triangle to a segment; of equally near ones (all that it pierces) that of lowest index.
  /// \return not Found() when nothing lies within max_distance or the segment is not finite
  /// \note Real-time safe: no allocation, lock or throw.
  SegmentContact FindNearestToSegment(std::span<const math::Vec3> positions, const Segment& segment,
                                      const SearchLimits& limits = {}) const noexcept;

  /// The nearest triangle to a capsule. limits.max_distance is the gap to the capsule's surface.
  /// \note Real-time safe: no allocation, lock or throw.
  CapsuleContact FindNearestToCapsule(std::span<const math::Vec3> positions, const Capsule& capsule,
                                      const SearchLimits& limits = {}) const noexcept;

  /// Every triangle that lies within `capsule` (a sphere where its ends are the same) or touches it.
  ///
  /// \param[out] found  as many indices as fit, ascending; which ones when they do not all fit is not said
  /// \return how many there are; when more than found.size(), the list is incomplete
  /// \note Real-time safe: no allocation, lock or throw.
  std::size_t FindWithin(std::span<const math::Vec3> positions, const Capsule& capsule,
                         std::span<std::uint32_t> found) const noexcept;

  /// Whether p lies inside of the surface: IsInside of queries.h with a look at the triangles along three rays.
  /// \return false where p is not finite
  /// \note Real-time safe: no allocation, lock or throw.
  bool IsInside(std::span<const math::Vec3> positions, const math::Vec3& p) const noexcept;

  std::span<const geometry::Triangle> Triangles() const noexcept { return triangles_; }

 private:
  std::vector<geometry::Triangle> triangles_;
  WideTree tree_;
};

}  // namespace trocar::collision
