// SPDX-License-Identifier: Apache-2.0
/// \file blade_sweep.h  Surface that a blade's edge sweeps from one tick to the next.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// The cutting edge of a blade, a straight piece.
struct BladeEdge {
  math::Vec3 a, b;  ///< ends [m]

  friend bool operator==(const BladeEdge&, const BladeEdge&) = default;
};

/// A flat convex piece of the surface that a blade swept: a triangle or a quadrilateral.
struct FlatSweep {
  std::array<math::Vec3, 4> corners;  ///< in order around it [m]
  std::size_t count = 0;              ///< 3 or 4
  math::Vec3 normal;                  ///< unit

  /// Distance to the plane, positive on the side of the normal [m].
  double Height(const math::Vec3& p) const noexcept { return math::Dot(p - corners[0], normal); }
};

/// A move of a blade whose sweep is flat.
struct FlatMove {
  BladeEdge before, now;
  FlatSweep sweep;
};

/// A move between two places of a blade: one flat move where the swept surface is flat and convex, else two, one
/// end of the blade after the other, over the shorter diagonal. Moves that sweep nothing (less than 1e-12 of
/// the blade's square) are left out.
struct BladeMoves {
  std::array<FlatMove, 2> moves;
  std::size_t count = 0;

  std::span<const FlatMove> Moves() const& { return std::span(moves).first(count); }
  std::span<const FlatMove> Moves() && = delete;  // a view of what is gone
};

/// \note Real-time safe, as all functions here.
BladeMoves MakeFlatMoves(const BladeEdge& before, const BladeEdge& now) noexcept;

/// The triangle between a point and a blade; empty where they lie on one line.
std::optional<FlatSweep> MakeFlatSweep(const math::Vec3& tip, const BladeEdge& blade) noexcept;

/// Box around a sweep [m].
Box CalcBox(const FlatSweep& sweep) noexcept;

/// Whether a point of the sweep's plane lies in it or, to 1e-9 of its size, on its border.
bool Contains(const FlatSweep& sweep, const math::Vec3& p) noexcept;

/// Where segment a-b crosses a sweep: the parameter in [0, 1] from a to b. Segments that lie in the plane do not
/// cross.
std::optional<double> FindCrossing(const FlatSweep& sweep, const math::Vec3& a, const math::Vec3& b) noexcept;

/// Where the segment meets a triangle, as a point of the triangle [m].
std::optional<math::Vec3> FindPiercing(const BladeEdge& segment, const math::Vec3& a, const math::Vec3& b,
                                       const math::Vec3& c) noexcept;

}  // namespace trocar::geometry
