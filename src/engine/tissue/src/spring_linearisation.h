// SPDX-License-Identifier: Apache-2.0
/// \file spring_linearisation.h  Springs that are cut, weakened or stiffen with strain, for solvers that know Hooke's law
/// alone: before a solve each is linearised at its present length, as the Hookean spring with the same tension and the
/// same tangent stiffness.
///
/// The inner loops stay as they are, with no branch and no state of a spring. Solves are repeated with springs linearised
/// anew (outer iterations) until their tensions hold. That is Newton's method over the springs: the error of an outer
/// iteration is about the square of the one before, and a tick starts from the lengths of the last.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "solver_model.h"
#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {

/// Nodes that one pass of the spring kernel works on side by side.
inline constexpr std::uint32_t kLanes = 8;

/// Half-springs in slices of kLanes nodes, each padded to its longest row (sliced ELLPACK): what the lanes
/// read at one step lies together. A padded entry points at its own node with no stiffness.
/// Source: Monakov, Lokhmotov, Avetisyan, "Automatically tuning sparse matrix-vector multiplication for GPU
/// architectures", HiPEAC 2010.
struct SlicedSprings {
  std::vector<std::uint32_t> starts;         // (slices + 1) in steps
  std::vector<std::uint32_t> others;         // (steps * kLanes)
  std::vector<double> stiffness;             // (steps * kLanes) k
  std::vector<double> stiffness_times_rest;  // (steps * kLanes) k l
};
/// \note Allocates nothing where the vectors have the capacity.
void SetSlicedSprings(const TissueModel& model, SlicedSprings& sliced);

/// The model with linearised springs, for solvers that go node by node in the caller's order.
struct LinearisedModel {
  TissueModel model;
  SlicedSprings sliced;
};

class SpringLinearisation {
 public:
  /// \param spare_share  capacity for so many times more springs
  explicit SpringLinearisation(double spare_share) : spare_share_(spare_share) {}
  /// Takes another model, whose springs are whole and at rest.
  ///
  /// \param model  the springs with their laws; must outlive this, as `made` of it must
  /// \note Allocates nothing where the spare share was enough.
  void SetModel(const TissueModel& model, const SolverModel& made);

  /// The linearised springs in the solvers' order.
  const OrderedSprings& Ordered() const { return ordered_; }
  /// The model with linearised springs; made when it is first asked for, and kept up to date from then on.
  const LinearisedModel& Nodewise();
  /// True where every spring is whole and follows Hooke's law: the linearised springs are the model's own.
  bool IsPlain() const { return changed_count_ == 0; }

  /// Takes over the factors of the state; false where one is negative or not finite.
  bool UpdateFactors(const TissueState& state) noexcept;
  /// Nodes that lost their last spring and have no virtual one: nothing constrains where they are.
  std::span<const std::uint32_t> Unconstrained() const { return unconstrained_; }

  /// Runs `solve` with the springs linearised at the state's lengths, again and again until their tensions hold.
  /// \param solve  SolveReport(const SolverSettings&): with what is left of the settings' bounds
  /// \note Real-time safe if `solve` is.
  template <typename Solve>
  SolveReport Iterate(SolverSettings settings, const TissueState& state, const Solve& solve) noexcept {
    if (elastic_.empty()) return solve(settings);
    (void)UpdateTangents(state);
    // which of the two bounds a solver keeps to; the choice that is left open keeps to both
    const bool counts_steps =
        settings.kind == SolverKind::kNewtonMultigrid || settings.kind == SolverKind::kAdaptive;
    const bool counts_iterations = settings.kind != SolverKind::kNewtonMultigrid;
    // without virtual springs it cannot tell that it arrived, and would leave nothing for a second outer iteration
    const bool ends_by_count = settings.kind == SolverKind::kAcceleratedDescent;
    const OuterIterationSettings& outer = settings.outer;
    SolverSettings next = settings;
    if (ends_by_count) next.max_iterations = std::max(1, settings.max_iterations / outer.max_count);
    SolveReport report = solve(next), last = report;
    while (last.is_finite) {
      report.law_error = UpdateTangents(state);
      const bool holds = report.law_error <= outer.law_error;
      if (holds && (last.converged || !ends_by_count)) break;
      report.converged = report.converged && holds;
      next.newton.max_steps -= counts_steps ? last.iterations : 0;
      next.newton.max_linear_total -= counts_steps ? last.linear_iterations : 0;
      next.max_iterations -= counts_iterations && !ends_by_count ? last.iterations : 0;
      if (report.outer_iterations >= outer.max_count || next.newton.max_steps <= 0 ||
          next.newton.max_linear_total <= 0 || next.max_iterations <= 0)
        break;
      last = solve(next);
      Add(last, report);
    }
    return report;
  }

 private:
  /// Linearises the springs that stiffen at the state's lengths.
  /// \return how far the tensions of the linearisation before were off there, over the largest tension [-]
  double UpdateTangents(const TissueState& state) noexcept;
  void FindUnconstrained() noexcept;
  void SetTangent(std::uint32_t spring, double stiffness, double rest_length) noexcept;
  static void Add(const SolveReport& outer_iteration, SolveReport& sum) noexcept;

  void SetNodewise(std::uint32_t spring, double stiffness, double rest_length) noexcept;

  double spare_share_;
  const TissueModel* model_ = nullptr;
  const SolverModel* made_ = nullptr;
  OrderedSprings ordered_;
  std::unique_ptr<LinearisedModel> nodewise_;
  std::vector<double> factor_;            // (springs) as they are linearised
  std::vector<std::uint32_t> elastic_;    // springs whose law stiffens
  std::vector<std::uint8_t> is_changed_;  // (springs) other than the model's own
  std::size_t changed_count_ = 0;
  std::vector<std::uint32_t> unconstrained_;
};

}  // namespace trocar::tissue
