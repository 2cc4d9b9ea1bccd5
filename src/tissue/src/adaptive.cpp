// SPDX-License-Identifier: Apache-2.0
/// \file adaptive.cpp  The solver that runs: fast where the start is far away, exact where it is near.
///
/// Newton's method with multigrid is exact and, from the last tick's positions, short; from a flat start it would walk
/// in steps of two springs' length. There, on a structured mesh, accelerated descent from coarse to fine comes within
/// a percent for the price of one Newton step. See docs/decisions/0014.
#include "solver_content.h"

namespace trocar::tissue {
namespace {

/// A start counts as far away when the estimated error is above this part of the largest displacement [-].
constexpr double kFarAway = 0.3;

}  // namespace

SolveReport SolveAdaptive(EquilibriumSolver::Content& c, const SolverSettings& settings, const TissueLoad& load,
                          TissueState& state) noexcept {
  SolveReport descent;
  if (c.accelerated->IsStructured()) {
    SolverSettings look = settings;
    look.max_newton_steps = 0;
    const SolveReport start = c.newton->Solve(*c.kernels, *c.workers, look, load, state);
    if (start.converged) return start;
    if (!(start.error <= kFarAway)) {
      descent = c.accelerated->Solve(*c.kernels, *c.workers, settings, load, state);
      if (descent.converged) return descent;
    }
  }
  SolveReport report = c.newton->Solve(*c.kernels, *c.workers, settings, load, state);
  report.coarse_levels = descent.coarse_levels;
  report.iterations += descent.iterations;
  return report;
}

}  // namespace trocar::tissue
