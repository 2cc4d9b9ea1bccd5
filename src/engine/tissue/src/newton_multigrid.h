// SPDX-License-Identifier: Apache-2.0
/// \file newton_multigrid.h  Newton's method with a trust region; each step by multigrid-preconditioned conjugate
/// gradients.
///
/// One solve: predict where the equilibrium has gone, linearise there, estimate the error; while it is too large, solve
/// for a step, search along it, bring the nodes that snap to rest by a local solve, project the constraints, linearise
/// and estimate again. docs/tissue.md derives the estimate.
#pragma once

#include <memory>
#include <span>

#include "linearisation.h"
#include "local_solve.h"
#include "pressure_stiffness.h"
#include "projected_preconditioner.h"
#include "solver_model.h"
#include "trocar/tissue/equilibrium.h"
#include "truncated_conjugate_gradients.h"
#include "trust_region.h"

namespace trocar::tissue {

/// Memory and methods of the Newton solver. Nothing in it outlasts a solve but what is made from the model.
class NewtonMultigrid {
 public:
  /// \param made, springs  of one model, the springs as they are linearised; must outlive this
  /// \param spare_share    capacity for so many times more links
  NewtonMultigrid(const SolverModel& made, const OrderedSprings& springs, double spare_share);
  /// Goes on with another model of as many nodes, whose springs `springs` holds by now.
  /// \note Allocates nothing where the spare share was enough.
  void SetModel(const SolverModel& made);
  /// Makes what solves with so many constraints need; else the first of them does.
  void Prepare(std::size_t constraints, bool follows_snap_through);
  NewtonMultigrid(const NewtonMultigrid&) = delete;  // parts point at each other
  NewtonMultigrid& operator=(const NewtonMultigrid&) = delete;

  /// \param max_error      see SolverSettings [-]
  /// \param constraints    null for none
  /// \param extrapolation  as EquilibriumSolver::Solve takes it; used with constraints only
  /// \note Real-time safe after Prepare(); bounded by settings.max_steps, max_linear_iterations and max_linear_total.
  SolveReport Solve(const Kernels& kernels, Workers& workers, double max_error,
                    const NewtonSettings& settings, const TissueLoad& load, TissueState& state,
                    ConstraintSet* constraints, std::span<const math::Vec3> extrapolation) noexcept;

 private:
  using SmallVector = ProjectedPreconditioner::SmallVector;

  /// Data that the phases of one solve share.
  struct Context {
    const Kernels& kernels;
    Workers& workers;
    double max_error;
    const NewtonSettings& settings;
    const TissueLoad& load;
    TissueState& state;
    ConstraintSet* constraints;
    bool follows_snap_through;
    TrustRegion region;
    SolveReport report;
    double displacement_scale = 0;    // largest distance of a node from rest [m]
    double visible_error = 0;         // longest of the preconditioned residual z_ [m]
    double smallest_ritz = INFINITY;  // of all steps since a fold snapped [-]
    double moved = 0;  // bound of how far any node went since the coarse levels were computed [m]
  };
  /// A Newton step, in step_.
  struct Step {
    TruncatedReport linear;
    double length = 0;           // longest move of a node [m]
    double energy_before = 0;    // [J]
    double slope = 0;            // of the energy along the whole step [J]
    double follower_energy = 0;  // what pressures add along the whole step, of second order [J]
    SmallVector multipliers_before{};
    bool IsUsable() const noexcept { return length > 0.0 && length < INFINITY; }
  };
  /// Part of a step that was taken, in position_.
  struct Advancement {
    double share = 0;           // of the step [-]
    bool is_lower = false;      // the energy fell as it should and the constraints are in reach
    SmallVector multipliers{};  // what the constraints carry of the residual there
    LocalSolve::Report local;
  };

  void Begin(Context& c) noexcept;
  void Predict(Context& c, std::span<const math::Vec3> extrapolation) noexcept;
  void Linearise(Context& c) noexcept;
  void UpdateCoarseLevels(Context& c) noexcept;
  void Estimate(Context& c) noexcept;
  Step SolveStep(Context& c) noexcept;
  Advancement SearchLine(Context& c, const Step& step) noexcept;
  void TryShare(Context& c, const Step& step, Advancement& advancement) noexcept;
  LocalSolve::Report SolveLocally(Context& c, const Step& step, const Advancement& advancement) noexcept;
  void ProjectConstraints(Context& c) noexcept;
  void FollowMove(Context& c, const Step& step, const Advancement& advancement) noexcept;
  void EstimateAfter(Context& c, const Step& step) noexcept;

  /// Iterations of conjugate gradients that the settings leave; a halved step costs as much as one.
  static int CountLeft(const Context& c) noexcept;
  static bool IsAtBound(const Context& c) noexcept;
  bool AreConstraintsInReach(Context& c) noexcept;
  void TakeSurfaces(const ConstraintSet& constraints) noexcept;
  void UpdatePressure(Context& c) noexcept;
  double CalcFollowerEnergy(Context& c) noexcept;
  void Multiply(Context& c, const Float4* x, Float4* out) noexcept;
  void ReadPositions(const TissueState& state, std::uint32_t first, std::uint32_t last) noexcept;
  void WriteBack(Workers& workers, TissueState& state) const noexcept;

  const OrderedModel* model_;
  const OrderedSprings* springs_;
  double spare_share_;
  OrderedLoad load_;
  LinkHierarchy hierarchy_;
  Linearisation linearisation_;
  PressureStiffness pressure_;
  std::unique_ptr<LocalSolve> local_solve_;  // for solves that follow snap-through
  ProjectedPreconditioner preconditioner_;
  math::AlignedVector<Double4> position_, start_;  // (padded)
  Balance balance_;
  math::AlignedVector<Float4> step_, r_, z_, p_, q_;  // (padded)
  bool has_follower_stiffness_ = false;               // whether pressures are in the stiffness of this solve
};

}  // namespace trocar::tissue
