// SPDX-License-Identifier: Apache-2.0
/// \file cuttable_tubes.h  Ducts and vessels among the nodes of the tissue, cut anywhere.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/geometry/centre_line_cut.h"
#include "trocar/surgery/blade.h"
#include "trocar/surgery/topology_change.h"

namespace trocar::surgery {

/// Ducts and vessels that can be cut. Point p of the graph is node Node(p) of the tissue.
///
/// A piece of an edge is stiffer than the whole as it is shorter, k l = const (springs in series), along the line and
/// from one point to the next but one, where tubes have their bending springs. Both end in the stump.
class CuttableTubes {
 public:
  /// \param first_spare, spare_count  nodes for the ends of cuts, two a cut, see AddSpareNodes
  CuttableTubes(std::uint32_t first_spare, std::uint32_t spare_count);

  /// \param first_node  of the tube's points, in order along it
  /// \param points, radii  (n) n >= 2 [m]
  void AddTube(std::uint32_t first_node, std::span<const math::Vec3> points, std::span<const double> radii);

  std::uint32_t Node(std::uint32_t p) const { return nodes_[p]; }
  const geometry::CentreLineGraph& Graph() const { return graph_; }

  /// Cuts what a move crosses.
  ///
  /// \param definition  as it is now: masses and springs of the nodes
  /// \param position    (n) of the whole system [m]
  /// \param[in,out] change  gets nodes and springs; see Reserve
  /// \param[out] cuts   one for each cut; at least kMostCuts
  /// \return how many cuts
  /// \note Real-time safe within the capacity of `change`.
  std::size_t Cut(const BladeMove& move, const tissue::TissueDefinition& definition,
                  std::span<const math::Vec3> position, TopologyChange& change,
                  std::span<geometry::CentreLineCut> cuts) noexcept;

  /// Most cuts in one tick.
  static constexpr std::size_t kMostCuts = 8;
  void ReserveFor(TopologyChange& change) const;

  /// The lines with their cuts.
  void VisitState(base::StateArchive& archive);

 private:
  void ListCut(const geometry::CentreLineCut& cut, const tissue::TissueDefinition& definition,
               TopologyChange& change) noexcept;

  geometry::CentreLineGraph graph_;
  std::vector<std::uint32_t> nodes_;  // (np)
  std::uint32_t next_spare_, end_spare_;
};

}  // namespace trocar::surgery
