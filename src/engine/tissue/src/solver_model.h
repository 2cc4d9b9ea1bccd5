// SPDX-License-Identifier: Apache-2.0
/// \file solver_model.h  Solver model: the order of a model's nodes in memory, and the levels of the multigrid.
#pragma once

#include <cstdint>
#include <vector>

#include "hierarchy_topology.h"
#include "linearisation.h"

namespace trocar::tissue {

/// A spring's two nodes, and its half-spring at each.
struct SpringEnds {
  std::uint32_t a, b;
  std::uint32_t half_a, half_b;
};

/// Constant: it depends on nodes and links as they are between two cuts, and not on where they are or which are whole. All
/// solvers of one model share it.
struct SolverModel {
  OrderedModel ordered;
  HierarchyTopology hierarchy;
  std::vector<SpringEnds> ends;  // (springs)
};

SolverModel MakeSolverModel(const TissueModel& model);

/// Memory of making it.
class SolverModelBuilder {
 public:
  /// \note Allocates nothing where Reserve() was enough.
  void Build(const TissueModel& model, SolverModel& made);
  /// Capacity, here and in `own`, for a model with `share` times more links than `like`.
  void Reserve(const SolverModel& like, double share, SolverModel& own);

 private:
  OrderedModelWorkspace ordered_;
  HierarchyBuilder hierarchy_;
};

}  // namespace trocar::tissue
