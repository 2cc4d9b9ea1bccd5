// SPDX-License-Identifier: Apache-2.0
/// \file newton_multigrid.h  Newton's method; each step by conjugate gradients that LinkHierarchy
/// preconditions.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "linearisation.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

/// Memory and methods of the Newton solver.
class NewtonMultigrid {
 public:
  explicit NewtonMultigrid(const TissueModel& model);

  /// \note Real-time safe; bounded by settings.max_newton_steps and max_linear_iterations.
  SolveReport Solve(const Kernels& kernels, Workers& workers, const SolverSettings& settings,
                    const TissueLoad& load, TissueState& state, const SolveHook* hook) noexcept;

  /// The springs it works with, for SpringLines to keep up to date.
  OrderedModel& Springs() noexcept { return model_; }

 private:
  struct LinearReport {
    int iterations = 0;
    bool met_negative_curvature = false;
    bool reached_radius = false;
  };
  /// Solves K step_ = residual until the preconditioned remainder, an estimate of the error left in the step,
  /// is below `tolerance` [m], or until a node has moved by `radius` [m].
  LinearReport SolveLinear(const Kernels& kernels, Workers& workers, int max_iterations, double tolerance,
                           double radius) noexcept;
  /// Takes the gradients of the active constraints, and what the preconditioner answers to each.
  void SetConstraints(const Kernels& kernels, Workers& workers, const SolveHook* hook) noexcept;
  /// z_ = about K^-1 r_ on the constraints; multipliers_ is what of r_ they carry.
  void Precondition(const Kernels& kernels, Workers& workers) noexcept;
  void Multiply(const Kernels& kernels, Workers& workers, const Float4* x, Float4* out) noexcept;

  OrderedModel model_;
  OrderedLoad load_;
  LinkHierarchy hierarchy_;
  Linearisation linearisation_;
  std::vector<Double4> position_, start_;  // (padded)
  Balance balance_;
  std::vector<Float4> step_, r_, z_, p_, q_;  // (padded)
  // constraints of the present step; their gradients share no node
  std::size_t constraint_count_ = 0;
  std::array<std::size_t, kMaxHookConstraints> constraint_index_{};  // in the hook
  std::vector<std::uint8_t> constraint_of_node_;                  // (n) place in this list, or kNoConstraint
  std::vector<Float4> gradient_;                                  // (padded)
  std::array<std::vector<Float4>, kMaxHookConstraints> answers_;  // (padded) M^-1 gradient
  std::array<std::array<double, kMaxHookConstraints>, kMaxHookConstraints> gram_{};  // gradient . answer
  std::array<double, kMaxHookConstraints> multipliers_{};
  double edge_length_ = 0;  // mean rest length of the springs [m]
};

}  // namespace trocar::tissue
