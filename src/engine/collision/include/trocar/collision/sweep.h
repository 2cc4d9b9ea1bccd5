// SPDX-License-Identifier: Apache-2.0
/// \file sweep.h  Contact in time: when a moving capsule first meets a moving triangle or tube between two
/// ticks.
///
/// Corners move along straight lines from their place at time 0 to that at time 1. A tool turns about its
/// trocar, so its points really run along arcs: at 2 m/s, 200 mm from the trocar and 120 ticks a second the
/// chord is 0.2 mm off.
#pragma once

#include <array>

#include "trocar/collision/segment_distance.h"
#include "trocar/collision/triangle_distance.h"

namespace trocar::collision {

/// First touch is found this far ahead of the exact contact at most [m].
inline constexpr double kSweepTolerance = 1e-6;

struct MovingSegment {
  Segment from, to;  ///< at time 0 and 1

  Segment At(double time) const {
    return {math::Lerp(from.start, to.start, time), math::Lerp(from.end, to.end, time)};
  }
};

struct MovingTriangle {
  std::array<math::Vec3, 3> from, to;  ///< at time 0 and 1

  std::array<math::Vec3, 3> At(double time) const {
    return {math::Lerp(from[0], to[0], time), math::Lerp(from[1], to[1], time),
            math::Lerp(from[2], to[2], time)};
  }
};

/// First time at which a moving segment and a moving body are within reach of each other.
template <typename Points>
struct Sweep {
  bool is_hit = false;
  double time = 1;  ///< of the touch in [0, 1], never later than the true one; 1 where there is none
  Points points;    ///< nearest points at that time
};
using TriangleSweep = Sweep<SegmentTrianglePoints>;
using TubeSweep = Sweep<SegmentSegmentPoints>;

/// Conservative advancement: at each step every pair of corners is followed along the direction between the
/// nearest points up to the moment at which the first could come within reach, so nothing is passed over.
///
/// \param reach  sum of the radii [m], >= 0
/// \note Real-time safe: no allocation, lock or throw; bounded in steps, and an answer that is not settled by
/// then is a hit at the time reached.
/// Source: Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996, section 2.3; Zhang, Lee and
/// Kim, "Interactive continuous collision detection for non-convex polyhedra", Visual Computer 22, 2006.
TriangleSweep SweepToTriangle(const MovingSegment& segment, const MovingTriangle& triangle,
                              double reach) noexcept;
/// SweepToTriangle() against a segment in place of the triangle: the axis of a piece of tube, or of another tool.
TubeSweep SweepToSegment(const MovingSegment& segment, const MovingSegment& axis, double reach) noexcept;

/// A capsule that holds every place which the moving segment passes.
Capsule CalcSweptCapsule(const MovingSegment& segment, double radius) noexcept;

}  // namespace trocar::collision
