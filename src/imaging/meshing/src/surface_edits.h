// SPDX-License-Identifier: Apache-2.0
/// \file surface_edits.h  Flips, collapses and moves of a closed surface that can be judged before they are made.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "editable_surface.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::meshing {

/// An edit may not leave neighbours whose normals differ more than this (cosine), unless they did before.
inline constexpr double kFoldCosine = -0.5;

/// A triangle where an edit would put it.
struct PlacedTriangle {
  std::uint32_t index = 0;
  geometry::Triangle triangle{};
  std::array<math::Vec3, 3> corners;
  geometry::Box box;
};

/// One local edit, not yet made: these triangles change, those vanish.
struct Edit {
  enum class Kind { kMove, kFlip, kCollapse };
  Kind kind = Kind::kMove;
  std::uint32_t a = 0, b = 0;  // vertices
  math::Vec3 point;            // where a goes
  EdgeNeighbours edge;         // of a flip
  std::vector<PlacedTriangle> changed;
  std::vector<std::uint32_t> removed;
};

/// A closed, manifold surface with the box of each triangle: local edits, what they would change, and whether that
/// would fold the surface or make it cut itself.
class SurfaceEdits {
 public:
  explicit SurfaceEdits(const geometry::TriangleMesh& mesh);

  const EditableSurface& Surface() const { return surface_; }

  /// The triangle as it is.
  PlacedTriangle Place(std::uint32_t t) const { return Place(t, surface_.TriangleAt(t)); }
  /// Smallest angle [rad].
  static double AngleOf(const PlacedTriangle& t) {
    return geometry::CalcSmallestAngle(t.corners[0], t.corners[1], t.corners[2]);
  }
  bool AreCutting(std::uint32_t t, std::uint32_t u) const;
  /// Pairs of triangles that cut each other, ascending.
  std::vector<std::array<std::uint32_t, 2>> FindCuts() const;

  Edit MakeMove(std::uint32_t v, const math::Vec3& p) const;
  /// \pre surface().CanFlip(edge)
  Edit MakeFlip(const EdgeNeighbours& edge) const;
  /// b goes into a, which moves to p.
  /// \pre surface().CanCollapse(a, b)
  Edit MakeCollapse(std::uint32_t a, std::uint32_t b, const math::Vec3& p) const;

  /// The edit's triangles as they are, those that would vanish too.
  std::vector<PlacedTriangle> PlaceBefore(const Edit& edit) const;
  /// Cuts among these triangles, and between them and all that the edit does not touch.
  std::size_t CountCuts(const std::vector<PlacedTriangle>& triangles, const Edit& edit) const;
  /// Smallest cosine between the normals of two of the triangles, or one of them and one beside, that share a
  /// side.
  double FindFold(const std::vector<PlacedTriangle>& triangles, const Edit& edit) const;
  /// Whether the edit leaves a fold sharper than kFoldCosine, and sharper than the one that is there.
  bool Folds(const Edit& edit, const std::vector<PlacedTriangle>& before) const;

  void Make(const Edit& edit);

 private:
  PlacedTriangle Place(std::uint32_t index, const geometry::Triangle& t) const;
  PlacedTriangle PlaceWith(std::uint32_t index, const geometry::Triangle& t, std::uint32_t v,
                           const math::Vec3& p) const;

  EditableSurface surface_;
  std::vector<geometry::Box> boxes_;
};

}  // namespace trocar::meshing
