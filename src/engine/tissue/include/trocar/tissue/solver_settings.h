// SPDX-License-Identifier: Apache-2.0
/// \file solver_settings.h  Choice of the equilibrium solver and its bounds.
#pragma once

#include <optional>
#include <string_view>

namespace trocar::tissue {

enum class SolverKind {
  kRelaxationPaper,       ///< x_i <- x_i + alpha R_i, node after node, as the paper prints it: the reference
  kGaussSeidelBrown2001,  ///< waves from the nodes that are out of balance, breadth first
  kChebyshevJacobi2015,   ///< Jacobi with 3 x 3 blocks accelerated by Chebyshev's recurrence, in double
                          ///< precision
  kAcceleratedDescent,  ///< the same recurrence in single precision and scalar steps; coarse to fine on grids
  kNewtonMultigrid,     ///< Newton's method, each step by multigrid-preconditioned conjugate gradients
  kAdaptive,            ///< what runs: accelerated descent from a cold start on a grid, then Newton as needed
};
inline constexpr SolverKind kSolverKinds[] = {
    SolverKind::kRelaxationPaper,    SolverKind::kGaussSeidelBrown2001, SolverKind::kChebyshevJacobi2015,
    SolverKind::kAcceleratedDescent, SolverKind::kNewtonMultigrid,      SolverKind::kAdaptive};
/// "relaxation", "gauss_seidel", "chebyshev", "accelerated", "newton", "adaptive"
std::string_view SolverName(SolverKind kind) noexcept;
/// The kind of that name; nothing for an unknown one.
std::optional<SolverKind> FindSolverKind(std::string_view name) noexcept;

/// Of the relaxation alone.
struct RelaxationSettings {
  double alpha = 0;  ///< step [m/N]; 0 takes half of the stability bound of Gershgorin's theorem

  friend bool operator==(const RelaxationSettings&, const RelaxationSettings&) = default;
};

/// Of Newton's method alone.
struct NewtonSettings {
  int max_steps = 40;              ///< per tick; two as a rule, many in a snap-through
  int max_linear_iterations = 60;  ///< of conjugate gradients, per step
  /// Most iterations in all steps of a tick together, halvings of steps that led uphill included, >= 1: bounds the tick's time.
  int max_linear_total = 100000;
  /// With constraints: whether to follow a fold through its snap-through. The few nodes that move far are then brought to
  /// rest by a local solve, the stiffness has the follower stiffness of pressures, and steps are solved until a mode that
  /// turns soft shows. A tick that ends at its bounds anyway has no time for it.
  bool follows_snap_through = true;

  friend bool operator==(const NewtonSettings&, const NewtonSettings&) = default;
};

/// Of the outer iterations, which linearise springs that stiffen and solve again, whichever the solver.
struct OuterIterationSettings {
  /// They end where the tensions are off by less than this part of the largest tension [-].
  double law_error = 1e-3;
  int max_count = 4;  ///< solves per tick, >= 1; they share the bounds of the solver

  friend bool operator==(const OuterIterationSettings&, const OuterIterationSettings&) = default;
};

/// Which solver runs, and what bounds it. Where a solve ends is said once for all solvers that end there; what one of them
/// alone needs stands in its own struct. Each solver is handed what it uses and sees nothing else (solver_content.h).
///
/// Work is bounded by counts and tolerances, never by the clock, so that results repeat.
struct SolverSettings {
  SolverKind kind = SolverKind::kAdaptive;
  /// Of every solver but Newton's: per tick, 1 to 100000. Forty of `chebyshev` fit into a tick of a patient.
  int max_iterations = 40;
  /// Relaxation, Gauss-Seidel, Chebyshev: stop when the largest residual of any free node is below this fraction of the
  /// largest force that any spring, load or contact exerts [-].
  double tolerance = 1e-4;
  RelaxationSettings relaxation;
  /// Accelerated descent, Newton: stop when the estimated distance of any node to the equilibrium is below this fraction of
  /// the largest distance of any node from rest [-].
  double max_error = 4e-4;
  NewtonSettings newton;
  OuterIterationSettings outer;

  friend bool operator==(const SolverSettings&, const SolverSettings&) = default;
};

}  // namespace trocar::tissue
