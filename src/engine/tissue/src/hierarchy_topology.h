// SPDX-License-Identifier: Apache-2.0
/// \file hierarchy_topology.h  The levels of the multigrid as far as they depend on the links alone: which nodes join, and
/// which coarse link each link is part of.
///
/// Nodes are joined along their stiffest links into aggregates, aggregates into larger ones, and so on. Source: Notay, "An
/// aggregation-based algebraic multigrid method", ETNA 37, 2010 (pairwise aggregation).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aggregation.h"
#include "slice_layout.h"
#include "workers.h"

namespace trocar::tissue {

/// A link between two aggregates and the coarse link that it is part of, in the row of the lower one.
struct CoarsenedLink {
  std::uint32_t entry, coarse_entry;
  std::uint32_t node;  // whose row `entry` is in
};

/// One level's links, and the way to the next level. Constant.
struct LevelTopology {
  static constexpr std::uint32_t kNoEntry = ~std::uint32_t{0};

  SliceLayout layout;
  std::vector<std::uint32_t> aggregate;               // (n) node of the next level, or Aggregation::kNone
  std::vector<std::uint32_t> member_starts, members;  // nodes of each aggregate
  /// Links that the next level gathers, in the order in which they lie in memory; chunk c of its slices gathers those from
  /// coarsened_starts[c] on.
  std::vector<CoarsenedLink> coarsened;
  std::vector<std::uint32_t> coarsened_starts;  // (chunks of the next level + 1)
  /// (entries) of a level that gathers: the link in its other node's row where that is the lower one, or kNoEntry.
  std::vector<std::uint32_t> mirror_entry;

  void SetGraph(const NodeGraph& graph);
  void Reserve(std::size_t nodes, std::size_t steps);
};

/// All levels. Constant.
struct HierarchyTopology {
  std::vector<LevelTopology> levels;  // finest first; the first level_count are in use
  std::size_t level_count = 0;

  const LevelTopology& Coarsest() const { return levels[level_count - 1]; }
};

/// Capacity of a level: as many nodes and steps as `like` has there, and `share` times more. With a share it is at least half
/// of the level before, because another graph may need other levels.
struct LevelCapacity {
  std::size_t nodes = 0, steps = 0;
};
std::vector<LevelCapacity> CalcLevelCapacities(const HierarchyTopology& like, double share);

/// Slices of a level of so many that one thread gathers at a time.
std::uint32_t CoarseChunkSize(std::uint32_t slices);

/// A level this small is solved directly.
inline constexpr std::uint32_t kDirectNodes = 24;
/// A level has at most nine tenths of the nodes of the one before; patients have six.
inline constexpr std::size_t kMaxLevels = 32;

/// Memory of making levels.
class HierarchyBuilder {
 public:
  /// \param graph      of the finest level, in its order
  /// \param stiffness  (graph.others) what joins nodes into aggregates, >= 0
  /// \note Allocates nothing where Reserve() was enough.
  void Build(const NodeGraph& graph, std::span<const double> stiffness, HierarchyTopology& made);
  /// Capacity, here and in `own`, for `share` times more nodes and links than `like` has.
  void Reserve(const HierarchyTopology& like, double share, HierarchyTopology& own);

 private:
  void FillTransfer(const NodeGraph& fine, const NodeGraph& coarse, std::size_t at, HierarchyTopology& made);

  Aggregation aggregation_;
  LinkGraph fine_;
  std::vector<std::uint32_t> places_, counts_, coarse_entry_;
};

}  // namespace trocar::tissue
