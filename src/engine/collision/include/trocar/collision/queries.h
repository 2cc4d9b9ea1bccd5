// SPDX-License-Identifier: Apache-2.0
/// \file queries.h  Queries of an instrument against an organ: how near the shaft is, whether the tip is inside, what lies
/// between the jaws.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "trocar/collision/centroid_hierarchy.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::collision {

/// Straight line between two points, for example the axis of a shaft [m].
struct Segment {
  math::Vec3 start, end;
};

/// Rounded cylinder about a segment.
struct Capsule {
  Segment axis;
  double radius = 0;  ///< [m], >= 0
};

/// Nearest triangle to a segment.
struct SegmentContact {
  NearestTriangle nearest;  ///< squared_distance is exactly 0 where the segment pierces the triangle
  double parameter = 0;     ///< of the segment's nearest point, 0 at its start, 1 at its end
  math::Vec3 on_segment;    ///< that point [m]

  bool Found() const { return nearest.Found(); }
};

/// Nearest triangle to a capsule.
struct CapsuleContact {
  SegmentContact axis;  ///< of the capsule's axis
  double distance =
      0;  ///< gap between the surfaces [m]; negative: depth of the overlap measured from the axis
  math::Vec3 on_capsule;  ///< the capsule's surface point towards the triangle; the axis point where the axis
                          ///< pierces it

  bool Found() const { return axis.Found(); }
};

/// The nearest triangle to a segment; of equally near ones (all that it pierces) that of lowest index.
///
/// \param positions  (nv) as at the hierarchy's last update [m]
/// \return not Found() when nothing lies within max_distance or the segment is not finite
/// \note Real-time safe: no allocation, lock or throw.
SegmentContact FindNearestToSegment(const CentroidHierarchy& hierarchy, std::span<const math::Vec3> positions,
                                    const Segment& segment, const SearchLimits& limits = {}) noexcept;

/// The nearest triangle to a capsule. limits.max_distance is the gap to the capsule's surface.
/// \note Real-time safe: no allocation, lock or throw.
CapsuleContact FindNearestToCapsule(const CentroidHierarchy& hierarchy, std::span<const math::Vec3> positions,
                                    const Capsule& capsule, const SearchLimits& limits = {}) noexcept;

/// Every triangle that lies within `capsule` or touches it.
///
/// \param[out] found  as many indices as fit, ascending
/// \return how many there are; when more than found.size(), the list is incomplete
/// \note Real-time safe: no allocation, lock or throw.
std::size_t FindTrianglesInCapsule(const CentroidHierarchy& hierarchy, std::span<const math::Vec3> positions,
                                   const Capsule& capsule, std::span<std::uint32_t> found) noexcept;

/// Part of a triangle on which a nearest point lies.
enum class SurfaceFeature { kVertex, kEdge, kFace };

/// A point's place relative to a closed surface.
struct SurfaceSide {
  SurfaceFeature feature = SurfaceFeature::kFace;
  math::Vec3 normal;  ///< unit pseudo-normal of the feature; zero where all triangles around it have no area
  double distance = 0;  ///< signed [m]: negative inside
};

/// On which side of the surface p lies, by the angle-weighted pseudo-normal of the nearest feature, computed
/// on the fly.
///
/// Right for closed, outward surfaces that do not cut themselves. Triangles without area add nothing to a
/// normal; where the normal is zero the side is not known and the distance is given as positive.
///
/// \param vertex_triangles  triangles around each vertex, geometry::FindVertexTriangles of the same triangles
/// \param nearest           result of FindNearest for p, Found() (TROCAR_ASSERT)
/// \note Real-time safe: no allocation, lock or throw.
/// Source: Baerentzen and Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE
/// TVCG 2005.
SurfaceSide FindSide(std::span<const math::Vec3> positions, std::span<const geometry::Triangle> triangles,
                     const geometry::Rows& vertex_triangles, const math::Vec3& p,
                     const NearestTriangle& nearest) noexcept;

/// Whether a point lies inside of a surface, however that is folded: three rays count how often they leave it more than they
/// enter it (its winding number), and two of them decide where it has a hole.
///
/// Unlike FindSide it needs no sound surface near the point, and it costs a look at every triangle.
/// \note Real-time safe.
bool IsInside(std::span<const math::Vec3> positions, std::span<const geometry::Triangle> triangles,
              const math::Vec3& p) noexcept;

}  // namespace trocar::collision
