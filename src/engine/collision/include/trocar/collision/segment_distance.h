// SPDX-License-Identifier: Apache-2.0
/// \file segment_distance.h  Distances between segments, and between capsules: tool against tool, tool against
/// duct.
#pragma once

#include "trocar/collision/queries.h"

namespace trocar::collision {

/// Parameters of the nearest points of segments p0-p1 and q0-q1; of near-parallel ones, of points that are near.
/// Source: Ericson, "Real-Time Collision Detection", 2005, section 5.1.9.
/// \note Real-time safe: no allocation, lock or throw.
void FindNearestParameters(const math::Vec3& p0, const math::Vec3& p1, const math::Vec3& q0,
                           const math::Vec3& q1, double& s, double& t) noexcept;

/// Nearest points of two segments.
struct SegmentSegmentPoints {
  double parameter_a = 0, parameter_b = 0;  ///< 0 at the start, 1 at the end
  math::Vec3 on_a, on_b;                    ///< [m]
  double squared_distance = 0;              ///< [m^2]
};

/// Nearest points of two segments. Tests the ends, too, which near-parallel segments need. Either may have no length.
/// \note Real-time safe: no allocation, lock or throw.
SegmentSegmentPoints FindNearestSegmentSegment(const Segment& a, const Segment& b) noexcept;

/// How far two capsules are apart.
struct CapsuleGap {
  SegmentSegmentPoints axes;
  double distance = 0;  ///< between the surfaces, negative where they overlap [m]
  math::Vec3 normal;    ///< unit, from a's axis to b's; zero where the axes cross
};
/// \note Real-time safe: no allocation, lock or throw.
CapsuleGap FindCapsuleGap(const Capsule& a, const Capsule& b) noexcept;

}  // namespace trocar::collision
