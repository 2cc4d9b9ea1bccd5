// SPDX-License-Identifier: Apache-2.0
/// \file accelerated_descent.h  Chebyshev's recurrence in single precision, with a coarse-to-fine start on
/// structured meshes: the fast solver for meshes of many thousand nodes.
///
/// Each node moves by R_i / (2 sum_j k_ij + k_v), a step that no position of the springs makes unstable
/// (Gershgorin), and the moves are accelerated by Chebyshev's recurrence (Wang, "A Chebyshev semi-iterative
/// approach for accelerating projective and position-based dynamics", ACM TOG 34(6), 2015). Where virtual
/// springs bound the lowest eigenvalue, the recurrence is tuned to it; where they do not, its cycles double.
/// On a structured mesh the start is solved on coarser meshes first (nested iteration: Brandt, "Multi-level
/// adaptive solutions to boundary-value problems", Math. Comp. 31, 1977).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "linearisation.h"
#include "spring_grid.h"
#include "spring_slices.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

/// Stopping criteria of the accelerated descent.
struct AcceleratedSettings {
  int max_iterations;
  double max_error;  ///< see SolverSettings [-]
};

class AcceleratedDescent {
 public:
  /// \param springs      in the solvers' order, as they are linearised; must outlive this
  /// \param spare_share  capacity for so many times more links
  AcceleratedDescent(const OrderedSprings& springs, double spare_share)
      : springs_(&springs), spare_share_(spare_share) {}
  /// Takes a model, or another of as many nodes.
  ///
  /// \param ordered     that model in the solvers' order; both must outlive this
  /// \param grid_shape  where it is a structured mesh and is to be taken as a stencil
  /// \note Allocates nothing where the spare share was enough and no structured mesh is or was there.
  void SetModel(const TissueModel& model, const OrderedModel& ordered,
                const std::optional<GridShape>& grid_shape);

  bool IsStructured() const { return !grids_.empty(); }
  /// True where every free node is at rest, and a coarse-to-fine start will be made.
  bool IsCold(const TissueState& state) const noexcept;
  /// True where virtual springs bound the lowest eigenvalue so well that one cycle damps everything.
  bool IsWellConditioned(const TissueLoad& load) const noexcept;
  /// Moves the free nodes from where they are. Contacts count by their force at the start of every cycle.
  /// \note Real-time safe; bounded by settings.max_iterations.
  SolveReport Solve(const Kernels& kernels, Workers& workers, const AcceleratedSettings& settings,
                    const TissueLoad& load, TissueState& state, ConstraintSet* constraints) noexcept;

 private:
  SolveReport SolveGrid(const Kernels& kernels, Workers& workers, const AcceleratedSettings& settings,
                        const TissueLoad& load, TissueState& state, ConstraintSet* constraints) noexcept;
  SolveReport SolveSlices(const Kernels& kernels, Workers& workers, const AcceleratedSettings& settings,
                          const TissueLoad& load, TissueState& state, ConstraintSet* constraints) noexcept;
  void SetGridLoads(const TissueLoad& load, const TissueState& state, std::size_t levels) noexcept;

  const OrderedSprings* springs_;
  double spare_share_;
  const TissueModel* model_ = nullptr;
  const OrderedModel* ordered_ = nullptr;
  double edge_length_ = 0;   // of the first spring [m]
  double lowest_ratio_ = 0;  // smallest k_virtual / sum k of a node [-]
  // structured
  std::vector<SpringGrid> grids_;  // finest first
  std::vector<GridLoad> loads_;
  // irregular
  OrderedLoad ordered_load_;
  std::unique_ptr<SpringSlices> slices_;
};

}  // namespace trocar::tissue
