// SPDX-License-Identifier: Apache-2.0
/// \file solver_content.h  Data that the solvers share, and the input that each is handed.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "accelerated_descent.h"
#include "element_matrix.h"
#include "newton_multigrid.h"
#include "spring_linearisation.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

/// Data of the nodes of a slice that an iteration needs, lane by lane. Rebuilt in every solve.
struct SliceData {
  double inverse_block[6][kLanes];  ///< xx, xy, xz, yy, yz, zz; zero for prescribed nodes, which then stay
  double shape_stiffness[kLanes];   ///< scaled [N/m]
  double rest[3][kLanes];           ///< [m]
  double other_force[3][kLanes];    ///< weight, external force, strands and contacts [N]
  double is_free[kLanes];           ///< 1, or 0 for prescribed nodes and padding
};

/// Factors of one iteration.
struct StepFactors {
  double stiffness_scale, damping, omega, max_step;
  bool is_first;  ///< of its cycle: the position before is the present one
};

/// Result of one slice of nodes: largest residual, largest force, and whether a step was cut short.
struct SliceReport {
  double residual2 = 0;       ///< largest squared residual of a free node [N^2]
  double force2 = 0;          ///< largest squared force of a spring or load on one [N^2]
  bool is_cut_short = false;  ///< a step was longer than max_step
};

/// One Chebyshev step of the nodes of a slice, from `position` into `previous`. The version for the machine
/// is chosen at run time; every version gives the same bits, because none contracts or reorders.
void UpdateSlice(const SlicedSprings& springs, const SliceData& data, const StepFactors& factors,
                 const math::Vec3* position, math::Vec3* previous, std::uint32_t node_count,
                 std::uint32_t slice, SliceReport& report) noexcept;

/// Stopping criteria of iterations that measure their residual.
struct IterationSettings {
  int max_iterations;
  double tolerance;  ///< on the residual [-]
};

/// Memory of Gauss-Seidel.
struct GaussSeidelScratch {
  explicit GaussSeidelScratch(std::size_t node_count);

  std::vector<std::uint32_t> wave;     // nodes of a sweep, in the order in which they are reached
  std::vector<std::uint32_t> visited;  // (n) last sweep that came by
  std::vector<double> residual;        // (n) [N]
};

/// Memory of the Chebyshev iteration.
struct ChebyshevScratch {
  ChebyshevScratch(const TissueModel& model, double spare_share);
  /// Goes on with another model of as many nodes.
  void SetModel(const TissueModel& model);

  std::vector<math::Vec3> previous;      // (n) positions of the iteration before
  std::vector<math::Symmetric3> blocks;  // (n) the node's own stiffness
  std::vector<SliceData> slices;
  std::vector<math::Vec3> constant_force;    // (n) weight and external force
  std::vector<std::uint32_t> strand_nodes;   // those with strands
  std::vector<std::uint32_t> touched_nodes;  // those with contacts or elements in this solve
  ElementMatrix element_bound;               // stiffness of the elements as though all of them acted
  std::vector<SliceReport> chunk_reports;
};

SolveReport SolveRelaxationPaper(const TissueModel& model, const IterationSettings& settings,
                                 const RelaxationSettings& relaxation, const TissueLoad& load,
                                 TissueState& state, ConstraintSet* constraints) noexcept;
SolveReport SolveGaussSeidelBrown2001(const TissueModel& model, GaussSeidelScratch& scratch,
                                      const IterationSettings& settings, const TissueLoad& load,
                                      TissueState& state, ConstraintSet* constraints) noexcept;
SolveReport SolveChebyshevJacobiWang2015(const LinearisedModel& springs, ChebyshevScratch& scratch,
                                         Workers& workers, const IterationSettings& settings,
                                         const TissueLoad& load, TissueState& state,
                                         ConstraintSet* constraints) noexcept;

/// Solvers and their memory. Each is made when it first runs, or before by Prepare(): most simulations run one for ever.
struct EquilibriumSolver::Content {
  Content(const TissueModel& model, const SolverOptions& options, std::shared_ptr<const SolverModel> made);
  void UpdateTopology(const TissueModel& model);
  void Prepare(const SolverSettings& settings, std::size_t constraints);

  SolveReport SolveChebyshev(const SolverSettings& settings, const TissueLoad& load, TissueState& state,
                             ConstraintSet* constraints) noexcept;
  SolveReport SolveAccelerated(int max_iterations, double max_error, const TissueLoad& load,
                               TissueState& state, ConstraintSet* constraints) noexcept;
  SolveReport SolveNewton(const SolverSettings& settings, const TissueLoad& load, TissueState& state,
                          ConstraintSet* constraints, std::span<const math::Vec3> extrapolation) noexcept;

  GaussSeidelScratch& GaussSeidel();
  ChebyshevScratch& Chebyshev();
  AcceleratedDescent& Accelerated();
  NewtonMultigrid& Newton();

  const TissueModel* laws;  // the caller's: springs with their laws
  SolverOptions options;
  // Constant, and shared with the other solvers of the same model; each outlives the one that made it. After a cut a solver
  // has one of its own, for which it has set memory aside.
  std::shared_ptr<const SolverModel> shared;
  SolverModel own;
  SolverModelBuilder builder;
  const SolverModel* made;  // the one that holds now
  std::optional<GridShape> grid;
  SpringLinearisation spring_linearisation;
  std::vector<NodeCondition>
      unconstrained_condition;  // of the nodes that a solve holds because nothing constrains them
  std::unique_ptr<Workers> workers;
  const Kernels* kernels;

 private:
  std::unique_ptr<GaussSeidelScratch> gauss_seidel_;
  std::unique_ptr<ChebyshevScratch> chebyshev_;
  std::unique_ptr<AcceleratedDescent> accelerated_;
  std::unique_ptr<NewtonMultigrid> newton_;
};

/// Accelerated descent where a structured mesh starts cold, then Newton until the error is small enough.
SolveReport SolveAdaptive(EquilibriumSolver::Content& content, const SolverSettings& settings,
                          const TissueLoad& load, TissueState& state, ConstraintSet* constraints,
                          std::span<const math::Vec3> extrapolation) noexcept;

/// Nodes a thread takes at a time; depends on the model alone, so that results do not depend on the threads.
inline std::uint32_t CalcChunk(std::size_t node_count) noexcept {
  const auto least = static_cast<std::uint32_t>(node_count / Workers::kMaxChunks + 1);
  return std::max(256u, (least + kLanes - 1) / kLanes * kLanes);
}

}  // namespace trocar::tissue
