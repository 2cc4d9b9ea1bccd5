// SPDX-License-Identifier: Apache-2.0
/// \file centre_line_cut.h  Ducts, vessels and strands cut anywhere along their centre lines.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/geometry/blade_sweep.h"
#include "trocar/geometry/mesh_topology.h"

namespace trocar::geometry {

/// Centre lines of ducts and vessels: points joined by edges, branches included. Points and edges are only ever
/// appended.
struct CentreLineGraph {
  std::vector<math::Vec3> rest, positions;  ///< (np) [m]
  std::vector<double> radii;                ///< (np) [m]
  std::vector<Edge> edges;                  ///< (ne) pairs of points, in the line's direction
  std::vector<std::uint8_t> is_cut_end;     ///< (np) 1 for an end that a cut made

  /// Capacity for cuts, so that they allocate nothing: each takes two points and an edge.
  void ReserveCuts(std::size_t count);
  /// How many more cuts there is capacity for.
  std::size_t CutCapacity() const;
};

/// All but positions, which follow the tissue.
void VisitState(base::StateArchive& archive, CentreLineGraph& graph);

/// Joins the points of one line, first to last.
/// \return index of the line's first point
std::uint32_t AddLine(std::span<const math::Vec3> points, std::span<const double> radii,
                      CentreLineGraph& graph);

/// One line cut in two.
struct CentreLineCut {
  std::uint32_t edge =
      0;  ///< a to b before; now it ends in `ends[0]`, and a new edge leads from ends[1] to b
  std::uint32_t new_edge = 0;
  std::uint32_t a = 0, b = 0;           ///< points
  double t = 0;                         ///< where, from a to b [-]
  std::array<std::uint32_t, 2> ends{};  ///< open ends, with the radius of the line there
};

/// A cut this near to an open end takes nothing off it [m].
inline constexpr double kLeastStump = 0.0005;

/// Cuts every line that a flat sweep crosses, in present positions. No piece of an edge is shorter than a tenth of it.
///
/// \param[out] cuts  the first ones that it has the capacity for; more are not made
/// \return how many
/// \pre graph.ReserveCuts was called; beyond its capacity nothing is cut
/// \note Real-time safe.
std::size_t CutCentreLines(const FlatSweep& sweep, CentreLineGraph& graph,
                           std::span<CentreLineCut> cuts) noexcept;

}  // namespace trocar::geometry
