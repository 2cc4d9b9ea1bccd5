// SPDX-License-Identifier: Apache-2.0
/// \file newton_multigrid.h  Newton's method; each step by conjugate gradients that LinkHierarchy
/// preconditions.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "linearisation.h"
#include "newton_patch.h"
#include "pressure_stiffness.h"
#include "trocar/math/small_solver.h"
#include "trocar/tissue/equilibrium.h"
#include "truncated_gradients.h"

namespace trocar::tissue {

/// Memory and methods of the Newton solver.
class NewtonMultigrid {
 public:
  using SmallVector = math::SmallVector<kMaxHookConstraints>;
  using SmallMatrix = math::SmallMatrix<kMaxHookConstraints>;

  explicit NewtonMultigrid(const TissueModel& model);
  /// Goes on with another model of as many nodes.
  /// \note Allocates nothing where Reserve() was enough.
  void SetModel(const TissueModel& model);
  void Reserve(double share);
  NewtonMultigrid(const NewtonMultigrid&) = delete;  // parts point at each other
  NewtonMultigrid& operator=(const NewtonMultigrid&) = delete;

  /// \note Real-time safe; bounded by settings.max_newton_steps, max_linear_iterations and max_linear_total.
  SolveReport Solve(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                    const TissueLoad& load, TissueState& state, const SolveHook* hook) noexcept;

  /// The springs it works with, for SpringLines to keep up to date, and for others to read.
  OrderedModel& Springs() noexcept { return model_; }

 private:
  /// Takes the hook's surfaces, and their pressures into the stiffness.
  void TakeSurfaces(const SolveHook& hook) noexcept;
  void UpdatePressure(const Kernels& kernels, Workers& workers, const SolveHook& hook) noexcept;
  /// What the pressures add to the energy along the whole step, of second order: 1/2 step_ . K step_ of theirs [J].
  double CalcTurning(const Kernels& kernels, Workers& workers) noexcept;
  /// Solves K step_ = residual until the preconditioned remainder is below `loose`, or the error left in the
  /// step is estimated below `tolerance` [m], or until a node has moved by `radius` [m].
  /// \param softest  smallest Ritz value of the steps before: this step is solved as deep as the estimate asks
  TruncatedReport SolveLinear(const Kernels& kernels, Workers& workers, int max_iterations, double loose,
                              double tolerance, double softest, double radius) noexcept;
  /// Takes the residual, the chains' factors and the gradients of the active constraints.
  void BeginStep(Workers& workers, const SolveHook* hook) noexcept;
  /// What the preconditioner answers to each gradient; from the step before while the preconditioner stays.
  void SetAnswers(const Kernels& kernels, Workers& workers) noexcept;
  struct Constraint {
    std::size_t index = 0;           // in the hook
    AlignedVector<Float4> gradient;  // (padded) G
    AlignedVector<Float4> answer;    // (padded) Y
  };
  /// Of each constraint's part with v.
  SmallVector CalcDots(const Kernels& kernels, Workers& workers, AlignedVector<Float4> Constraint::*part,
                       const AlignedVector<Float4>& v) const noexcept;
  /// from -= sum of shares of each constraint's part, of some of the nodes
  void Subtract(const Kernels& kernels, const SmallVector& shares, AlignedVector<Float4> Constraint::*part,
                AlignedVector<Float4>& from, std::uint32_t first, std::uint32_t last) const noexcept;
  /// Lets the constraints carry of r_ what they can; multipliers_ is all that they carry.
  void ProjectResidual(const Kernels& kernels, Workers& workers) noexcept;
  /// z_ = about K^-1 r_ on the constraints: P M^-1 P^T r_ with P = I - Y (G^T Y)^-1 G^T, which is symmetric and
  /// stays on the constraints whatever Y is, and is best with Y = M^-1 G (Gould, Hribar, Nocedal, "On the
  /// solution of equality constrained quadratic programming problems arising in optimization", SIAM J. Sci.
  /// Comput. 23, 2001).
  DotAndLongest Precondition(const Kernels& kernels, Workers& workers) noexcept;
  void ReadPositions(const TissueState& state, std::uint32_t first, std::uint32_t last) noexcept;
  void WriteBack(Workers& workers, TissueState& state) const noexcept;
  /// Brings the nodes that the step moved farthest to rest on their own, the constraints carrying what they do.
  /// \param tolerance  error that may be left [m]
  /// \return what was done; no steps where nothing was gathered
  NewtonPatch::Report SolvePatch(const Kernels& kernels, Workers& workers,
                                 std::span<const std::uint8_t> strand_is_intact, double longest,
                                 double tolerance, const SmallVector& multipliers) noexcept;
  /// Begins where the hook's lead goes to if the energy is lower there and the constraints are in reach.
  bool TakeLead(const Kernels& kernels, Workers& workers, const SolveHook& hook, TissueState& state) noexcept;
  void Multiply(const Kernels& kernels, Workers& workers, const Float4* x, Float4* out) noexcept;
  void SetEdgeLength() noexcept;

  OrderedModel model_;
  OrderedLoad load_;
  LinkHierarchy hierarchy_;
  Linearisation linearisation_;
  PressureStiffness pressure_;
  NewtonPatch patch_;
  AlignedVector<Double4> position_, start_;  // (padded)
  Balance balance_;
  AlignedVector<Float4> step_, r_, z_, p_, q_;  // (padded)
  std::array<Constraint, kMaxHookConstraints> constraints_room_;
  std::span<Constraint> constraints_;  // of the present step
  bool has_answers_ = false;
  bool has_turns_ = false;  // whether the pressures are in the stiffness
  SmallMatrix gram_{};      // G^T Y
  SmallVector multipliers_{};
  double edge_length_ = 0;  // mean rest length of the springs [m]
};

}  // namespace trocar::tissue
