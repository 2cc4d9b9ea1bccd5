// SPDX-License-Identifier: Apache-2.0
/// \file spring_linearisation.h  Springs that are cut, weakened or stiffen with strain, for solvers that know Hooke's law
/// only: before a solve each spring becomes the line that touches its law at its present length.
///
/// The inner loops stay as they are, with no branch and no state of a spring; a solve is repeated with new lines
/// until they no longer change the forces. That is Newton's method over the springs: its error is squared from
/// round to round, and a tick starts from the lines of the last.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "linearisation.h"
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
/// \note Allocates nothing where the vectors have room.
void SetSlicedSprings(const TissueModel& model, SlicedSprings& sliced);

class SpringLines {
 public:
  /// \param model    the springs with their laws; must outlive this
  /// \param sliced, ordered  where the solvers keep the springs
  SpringLines(const TissueModel& model, SlicedSprings& sliced, OrderedModel& ordered);
  /// Goes on with another model, which the solvers' springs have followed.
  /// \note Allocates nothing where Reserve() was enough.
  void SetModel(const TissueModel& model);
  void Reserve(double share);

  /// The model with the lines in place of the springs.
  const TissueModel& Model() const { return lines_; }
  /// True where every spring is whole and follows Hooke's law: the lines are the model's own springs.
  bool ArePlain() const { return changed_count_ == 0; }

  /// Takes over the factors of the state; false where one is negative or not finite.
  bool TakeFactors(const TissueState& state) noexcept;
  /// Nodes that lost their last spring and have no virtual one: nothing says where they belong.
  std::span<const std::uint32_t> Adrift() const { return adrift_; }

  /// Runs `solve` with the lines of the state's springs, again and again until the lines hold.
  /// \param solve  SolveReport(const SolverSettings&): with what is left of the settings' bounds
  /// \note Real-time safe if `solve` is.
  template <typename Solve>
  SolveReport Follow(SolverSettings settings, const TissueState& state, const Solve& solve) noexcept {
    if (elastic_.empty()) return solve(settings);
    (void)TakeLengths(state);
    // which of the two bounds a solver keeps to; the choice that is left open keeps to both
    const bool counts_steps =
        settings.kind == SolverKind::kNewtonMultigrid || settings.kind == SolverKind::kAdaptive;
    const bool counts_iterations = settings.kind != SolverKind::kNewtonMultigrid;
    // without virtual springs it cannot tell that it arrived, and would leave nothing for a second round
    const bool ends_by_count = settings.kind == SolverKind::kAcceleratedDescent;
    SolverSettings next = settings;
    if (ends_by_count) next.max_iterations = std::max(1, settings.max_iterations / settings.max_rounds);
    SolveReport report = solve(next), round = report;
    while (round.is_finite) {
      report.law_error = TakeLengths(state);
      const bool holds = report.law_error <= settings.law_error;
      if (holds && (round.converged || !ends_by_count)) break;
      report.converged = report.converged && holds;
      next.max_newton_steps -= counts_steps ? round.iterations : 0;
      next.max_linear_total -= counts_steps ? round.linear_iterations : 0;
      next.max_iterations -= counts_iterations && !ends_by_count ? round.iterations : 0;
      if (report.rounds >= settings.max_rounds || next.max_newton_steps <= 0 || next.max_linear_total <= 0 ||
          next.max_iterations <= 0)
        break;
      round = solve(next);
      Add(round, report);
    }
    return report;
  }

 private:
  /// Lays new lines for the springs that stiffen.
  /// \return how far the lines before were off at these lengths, over the largest tension [-]
  double TakeLengths(const TissueState& state) noexcept;
  void FindAdrift() noexcept;
  void SetLine(std::uint32_t spring, double stiffness, double rest_length) noexcept;
  static void Add(const SolveReport& round, SolveReport& sum) noexcept;

  struct Ends {
    std::uint32_t a, b;            // nodes
    std::uint32_t half_a, half_b;  // half-springs at each
    std::size_t sliced_a, sliced_b;
  };
  const TissueModel* model_;
  SlicedSprings* sliced_;
  OrderedModel* ordered_;
  TissueModel lines_;
  std::vector<Ends> ends_;                // (springs)
  std::vector<double> factor_;            // (springs) as the lines have it
  std::vector<std::uint32_t> elastic_;    // springs whose law stiffens
  std::vector<std::uint8_t> is_changed_;  // (springs) line other than the model's spring
  std::size_t changed_count_ = 0;
  std::vector<std::uint32_t> adrift_;
};

}  // namespace trocar::tissue
