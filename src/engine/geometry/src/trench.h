// SPDX-License-Identifier: Apache-2.0
/// \file trench.h  Opens a cut in a solid organ and closes it again with the two walls of a V-shaped trench.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/surface_cut.h"

namespace trocar::geometry {

/// Below each vertex that a cut parts lies one bottom vertex; each opened edge gets a wall on either side, from its
/// rim to the line of the bottoms. Where a cut ends, rim and bottom are one vertex. A closed manifold stays one.
class TrenchBuilder {
 public:
  TrenchBuilder(std::size_t vertex_capacity, std::size_t triangle_capacity);

  /// Opens the scored edges around the vertices of a path and builds their walls. Where a wall would have too
  /// small an angle, or no place in the organ, the edges around that vertex are no longer scored.
  void Open(std::span<const std::uint32_t> path, const FlatSweep& sweep, const CutSettings& settings,
            EditableMesh& mesh, CutReport& report) noexcept;

 private:
  /// kUnseen: no end of an edge that is to be opened. kIsEnd: of one that stays whole.
  enum class Bottom : std::uint8_t { kUnseen, kNotLooked, kIsEnd, kPlanned };
  /// A position at rest and now.
  struct Place {
    math::Vec3 rest, now;
  };

  void AddValleys(std::span<const std::uint32_t> path, EditableMesh& mesh) noexcept;
  bool PlanBottoms(std::span<const std::uint32_t> path, const FlatSweep& sweep, const CutSettings& settings,
                   EditableMesh& mesh, CutReport& report) noexcept;
  bool FindBottom(std::uint32_t v, const FlatSweep& sweep, const CutSettings& settings,
                  const EditableMesh& mesh) noexcept;
  bool WallsAreGood(std::uint32_t v, const Place& bottom, double min_angle,
                    const EditableMesh& mesh) const noexcept;
  void BuildWalls(std::uint32_t h, EditableMesh& mesh) noexcept;
  void JoinWalls(EditableMesh& mesh) noexcept;
  void AddWall(const Triangle& corners, EditableMesh& mesh) noexcept;

  std::vector<Bottom> state_;              // (nv)
  std::vector<Place> place_;               // (nv) of the bottom that is planned below
  std::vector<std::uint32_t> bottom_of_;   // (nv) vertex below, made by this opening, or kNone
  std::uint32_t first_copy_ = 0;           // vertices from here on are copies made by this opening
  std::vector<std::uint32_t> vertices_;    // ends of scored edges, those of the path first
  std::vector<std::uint32_t> scored_;      // half-edges
  std::vector<std::uint32_t> open_sides_;  // half-edges that wait for their neighbour
};

}  // namespace trocar::geometry
