// SPDX-License-Identifier: Apache-2.0
/// \file editable_surface.h  A closed manifold surface whose edges can be collapsed and flipped.
/// Source of the link condition: Dey, Edelsbrunner, Guha, Nekhayev, "Topology preserving edge contraction",
/// 1999.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "trocar/geometry/triangle_mesh.h"

namespace trocar::meshing {

inline constexpr std::uint32_t kNoVertex = 0xffffffffu;

/// Two triangles t = (a, b, c) and other = (b, a, d) across an edge a-b.
struct EdgeNeighbours {
  std::uint32_t t = 0, other = 0;
  std::uint32_t a = 0, b = 0, c = 0, d = 0;

  /// Triangles that a flip of the edge puts in the place of t and other.
  geometry::Triangle FlippedFirst() const { return {a, d, c}; }
  geometry::Triangle FlippedSecond() const { return {d, b, c}; }
};

/// Triangles and vertices keep their numbers while the surface is edited; Take leaves the dead ones out.
class EditableSurface {
 public:
  explicit EditableSurface(const geometry::TriangleMesh& mesh);

  std::size_t TriangleCount() const { return live_; }
  std::size_t VertexSlots() const { return positions_.size(); }
  std::size_t TriangleSlots() const { return triangles_.size(); }
  bool IsAlive(std::uint32_t t) const { return alive_[t] != 0; }
  const geometry::Triangle& TriangleAt(std::uint32_t t) const { return triangles_[t]; }
  const math::Vec3& Position(std::uint32_t v) const { return positions_[v]; }
  /// Triangles around a vertex; none for a vertex that is gone.
  const std::vector<std::uint32_t>& Around(std::uint32_t v) const { return around_[v]; }
  math::Vec3 AreaNormal(const geometry::Triangle& t) const;

  /// Neighbours of v along edges, ascending.
  void GatherNeighbours(std::uint32_t v, std::vector<std::uint32_t>& ring) const;
  bool AreNeighbours(std::uint32_t v, std::uint32_t w) const;
  /// Side i of triangle t, from its corner i to the next.
  EdgeNeighbours FindAcross(std::uint32_t t, int i) const;

  /// Whether the surface stays closed and manifold when a and b become one: they share exactly the two
  /// vertices opposite of their edge, and no vertex is left with fewer than three triangles.
  bool CanCollapse(std::uint32_t a, std::uint32_t b) const;
  /// Whether c and d are no neighbours yet and a and b keep three triangles.
  bool CanFlip(const EdgeNeighbours& edge) const;

  /// b goes into a, which moves to p.
  /// \pre CanCollapse
  void Collapse(std::uint32_t a, std::uint32_t b, const math::Vec3& p);
  /// \pre CanFlip
  void Flip(const EdgeNeighbours& edge);
  void Move(std::uint32_t v, const math::Vec3& p) { positions_[v] = p; }

  geometry::TriangleMesh Take() const;

 private:
  std::vector<math::Vec3> positions_;
  std::vector<geometry::Triangle> triangles_;
  std::vector<char> alive_;
  std::vector<std::vector<std::uint32_t>> around_;
  std::size_t live_;
  mutable std::vector<std::uint32_t> ring_a_, ring_b_;  // scratch
};

/// The mesh without the vertices that no triangle names.
geometry::TriangleMesh DropUnusedVertices(const geometry::TriangleMesh& mesh);

}  // namespace trocar::meshing
