// SPDX-License-Identifier: Apache-2.0
/// \file editable_mesh.h  A manifold surface that can be cut while it is in use: edges are split, cuts are
/// opened, and nothing is allocated.
///
/// Vertices and triangles are only ever appended, so their numbers stay valid. Connectivity is a table of
/// half-edges: half-edge 3 t + i runs from corner i of triangle t to the next corner. A surface edge can be
/// *scored*: cut, but not yet open, because both of its sides still share both ends (the first edge of a slit).
/// Source of the data structure: Muller and Preparata, "Finding the intersection of two convex polyhedra",
/// 1978, here on triangles alone.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/base/state_archive.h"
#include "trocar/geometry/mesh_topology.h"
#include "trocar/geometry/triangle_mesh.h"

namespace trocar::geometry {

/// No half-edge, triangle or vertex.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Origin of a vertex.
enum class VertexOrigin : std::uint8_t {
  kGiven,   ///< of the mesh as it came
  kSplit,   ///< on an edge or in a triangle
  kCopy,    ///< the other side of a cut at from[0]
  kTrench,  ///< the bottom of a trench below from[0]
};
struct VertexSource {
  VertexOrigin origin = VertexOrigin::kGiven;
  std::array<std::uint32_t, 3> from = {kNone, kNone, kNone};  ///< vertices, kNone where fewer
  std::array<double, 3> weights = {0, 0, 0};                  ///< barycentric, >= 0, sum 1; 0 for kNone [-]
};

void VisitState(base::StateArchive& archive, VertexSource& source);

/// Part of the mesh to which a triangle belongs.
enum class TriangleKind : std::uint8_t {
  kSurface,  ///< of the surface as it came, or a part of such a triangle
  kWall      ///< inside of a trench
};

/// A triangle as it was before the first edit since ClearJournal.
struct TouchedTriangle {
  std::uint32_t triangle = 0;
  Triangle corners{};
  Triangle across{};  ///< corner beyond side i, from corner i to the next; kNone at a boundary
};

class EditableMesh {
 public:
  /// \param rest       manifold, with or without boundary; other triangles than those of `rest` never touch it
  /// \param spare_vertices, spare_triangles  capacity for edits
  /// \return kMeshInvalid: an index out of range, a position that is not finite, not manifold
  /// \note Not real-time safe: allocates all memory that edits need.
  static base::Result<EditableMesh> Make(const TriangleMesh& rest, std::size_t spare_vertices,
                                         std::size_t spare_triangles);

  std::size_t VertexCount() const { return rest_.size(); }
  std::size_t TriangleCount() const { return triangles_.size(); }
  std::size_t VertexCapacity() const { return vertex_capacity_; }
  std::size_t TriangleCapacity() const { return triangle_capacity_; }
  /// Whether so many more fit.
  bool HasCapacity(std::size_t vertices, std::size_t triangles) const {
    return VertexCount() + vertices <= vertex_capacity_ && TriangleCount() + triangles <= triangle_capacity_;
  }

  std::span<const math::Vec3> Rest() const { return rest_; }            ///< (nv) [m]
  std::span<const math::Vec3> Positions() const { return positions_; }  ///< (nv) now [m]
  std::span<const Triangle> Triangles() const { return triangles_; }
  std::span<const TriangleKind> Kinds() const { return kinds_; }      ///< (nt)
  std::span<const VertexSource> Sources() const { return sources_; }  ///< (nv)
  TriangleMesh RestMesh() const { return {rest_, triangles_}; }
  TriangleMesh PresentMesh() const { return {positions_, triangles_}; }

  /// Follows the tissue.
  /// \param positions  (nv) [m]
  /// \note Real-time safe, as all that follows unless said otherwise.
  void SetPositions(std::span<const math::Vec3> positions) noexcept;

  // --- half-edges
  static std::uint32_t TriangleOf(std::uint32_t h) { return h / 3; }
  static std::uint32_t Next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t Previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t From(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t To(std::uint32_t h) const { return From(Next(h)); }
  std::uint32_t Opposite(std::uint32_t h) const { return From(Previous(h)); }
  /// Twin half-edge: the same edge in the neighbouring triangle; kNone at a boundary.
  std::uint32_t Twin(std::uint32_t h) const { return twins_[h]; }
  bool IsScored(std::uint32_t h) const { return scored_[h] != 0; }
  /// Corner of the neighbour that faces the edge, or kNone at a boundary.
  std::uint32_t Across(std::uint32_t h) const { return twins_[h] == kNone ? kNone : Opposite(twins_[h]); }
  /// Some half-edge that leaves v.
  std::uint32_t Outgoing(std::uint32_t v) const { return outgoing_[v]; }
  /// The half-edge from a to b, or kNone. A boundary edge has only one direction.
  std::uint32_t FindHalfEdge(std::uint32_t a, std::uint32_t b) const noexcept;
  /// Either half-edge of edge a-b, or kNone.
  std::uint32_t FindEdge(std::uint32_t a, std::uint32_t b) const noexcept;
  /// The first half-edge around v: at a boundary the one after which no triangle follows clockwise.
  std::uint32_t FirstAround(std::uint32_t v) const noexcept;
  /// The next half-edge that leaves the same vertex, counter-clockwise; kNone at a boundary.
  std::uint32_t NextAround(std::uint32_t h) const { return twins_[Previous(h)]; }
  /// Calls act(half-edge) for each triangle around v, counter-clockwise.
  template <typename Act>
  void ForEachAround(std::uint32_t v, Act act) const {
    const std::uint32_t first = FirstAround(v);
    for (std::uint32_t h = first; h != kNone;) {
      act(h);
      h = NextAround(h);
      if (h == first) break;
    }
  }
  bool IsBoundary(std::uint32_t v) const noexcept { return twins_[FirstAround(v)] == kNone; }
  /// Scored edges that end in v.
  int CountScored(std::uint32_t v) const noexcept;

  // --- edits
  /// Puts a vertex on an edge and divides its one or two triangles. Areas stay; a scored edge stays scored.
  /// \param t  from From(h) to To(h), in (0, 1) [-]
  /// \return the new vertex, its half-edge to To(h) is Outgoing
  /// \pre HasCapacity(1, 2)
  std::uint32_t SplitEdge(std::uint32_t h, double t) noexcept;

  /// Puts a vertex into a triangle and divides it into three.
  /// \param weights  barycentric, > 0, sum 1 [-]
  /// \pre HasCapacity(1, 2)
  std::uint32_t SplitTriangle(std::uint32_t t, const std::array<double, 3>& weights) noexcept;

  /// Marks an inner edge as cut, or takes the mark back.
  void SetScored(std::uint32_t h, bool is_scored) noexcept;

  /// How many copies opening makes of v: the parts into which scored edges and boundary divide its triangles,
  /// less one.
  int CountCopies(std::uint32_t v) const noexcept;

  /// Gives each part of v's triangles a vertex of its own; the part with the triangle of the lowest number
  /// keeps v.
  /// \return number of copies, the last vertices
  /// \pre HasCapacity(CountCopies(v), 0)
  int SeparateParts(std::uint32_t v) noexcept;

  /// Makes a scored edge whose sides share no longer both ends a boundary.
  /// \return whether it did
  bool Open(std::uint32_t h) noexcept;

  /// Adds a vertex below another, as part of a trench; AddTriangle connects it.
  /// \pre HasCapacity(1, 0)
  std::uint32_t AddVertex(const VertexSource& source, const math::Vec3& rest,
                          const math::Vec3& position) noexcept;
  /// Adds a triangle without neighbours; Join connects it.
  /// \pre HasCapacity(0, 1)
  std::uint32_t AddTriangle(const Triangle& corners, TriangleKind kind) noexcept;
  /// Makes two boundary half-edges one inner edge.
  /// \pre they run in opposite directions between the same vertices
  void Join(std::uint32_t h, std::uint32_t g) noexcept;

  // --- what changed
  /// Triangles edited since ClearJournal that were there then; new ones follow its TriangleCount.
  std::span<const TouchedTriangle> Journal() const { return journal_; }
  std::size_t JournalVertices() const { return journal_vertices_; }    ///< VertexCount at ClearJournal
  std::size_t JournalTriangles() const { return journal_triangles_; }  ///< TriangleCount at ClearJournal
  void ClearJournal() noexcept;

  /// All but positions, which follow the tissue, and the journal, which is cleared. Restoring refuses what is no mesh
  /// within this one's capacity; then the mesh has to be restored again before it is used.
  void VisitState(base::StateArchive& archive);

 private:
  EditableMesh() = default;
  void Touch(std::uint32_t t) noexcept;
  void SetTwins(std::uint32_t h, std::uint32_t g) noexcept;

  std::size_t vertex_capacity_ = 0, triangle_capacity_ = 0;
  std::vector<math::Vec3> rest_, positions_;
  std::vector<VertexSource> sources_;
  std::vector<std::uint32_t> outgoing_;
  std::vector<Triangle> triangles_;
  std::vector<TriangleKind> kinds_;
  std::vector<std::uint32_t> twins_;  // (3 nt)
  std::vector<std::uint8_t> scored_;  // (3 nt)
  std::vector<TouchedTriangle> journal_;
  std::vector<std::uint8_t> is_touched_;  // (nt)
  std::size_t journal_vertices_ = 0, journal_triangles_ = 0;
};

}  // namespace trocar::geometry
