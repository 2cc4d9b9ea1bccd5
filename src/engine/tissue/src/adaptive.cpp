// SPDX-License-Identifier: Apache-2.0
/// \file adaptive.cpp  The solver that runs: fast where the start is far away, exact where it is near.
///
/// Newton's method with multigrid is exact and, from the last tick's positions, short; from a flat start it
/// would walk in steps of a fraction of a spring's length. There, on a structured mesh, accelerated descent
/// from coarse to fine comes within a thousandth for the price of one or two Newton steps; and where virtual
/// springs bound the lowest eigenvalue it ends by itself, with a bound on its error. With constraints whose
/// gradients are not known the double-precision recurrence runs. See docs/solver.md.
#include "solver_content.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::tissue {
namespace {

/// Iterations of a descent: on the largest grid of the paper they cost what one Newton step does, and come
/// within a thousandth (docs/tissue.md).
constexpr int kDescentIterations = 400;

}  // namespace

SolveReport SolveAdaptive(EquilibriumSolver::Content& c, const SolverSettings& settings,
                          const TissueLoad& load, TissueState& state, ConstraintSet* constraints,
                          std::span<const math::Vec3> extrapolation) noexcept {
  // A whole Newton step between two projections undoes constraints whose gradients it does not know, and pressure
  // and shape then swing about each other. The recurrence projects every few iterations.
  if (constraints != nullptr && constraints->Nodes().empty())
    return c.SolveChebyshev(settings, load, state, constraints);
  SolveReport descent;
  if (constraints == nullptr && c.grid.has_value() && c.spring_linearisation.IsPlain() &&
      !HasElements(load)) {
    if (c.Accelerated().IsCold(state) || c.Accelerated().IsWellConditioned(load)) {
      descent = c.SolveAccelerated(kDescentIterations, settings.max_error, load, state, nullptr);
      if (descent.converged) return descent;
    }
  }
  SolveReport report = c.SolveNewton(settings, load, state, constraints, extrapolation);
  report.coarse_levels = descent.coarse_levels;
  report.iterations += descent.iterations;
  return report;
}

}  // namespace trocar::tissue
