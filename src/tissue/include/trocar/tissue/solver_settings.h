// SPDX-License-Identifier: Apache-2.0
/// \file solver_settings.h  Choice of the equilibrium solver and its bounds.
#pragma once

#include <string_view>

namespace trocar::tissue {

enum class SolverKind {
  kRelaxationPaper,      ///< x_i <- x_i + alpha R_i, node after node, as the paper prints it: the reference
  kChebyshevJacobi2015,  ///< Jacobi accelerated by Chebyshev's recurrence (Wang 2015): the one that runs
};
/// "relaxation", "chebyshev"
std::string_view SolverName(SolverKind kind) noexcept;

/// Work is bounded by counts and tolerances, never by the clock, so that results repeat.
struct SolverSettings {
  SolverKind kind = SolverKind::kChebyshevJacobi2015;
  int max_iterations = 40;  ///< per tick, 1 to 100000
  /// Stop when the largest residual of any free node is below this fraction of the largest force that any
  /// spring, load or contact exerts [-].
  double tolerance = 1e-4;
  double alpha = 0;  ///< step of the relaxation [m/N]; 0 takes the stability bound of Gershgorin's theorem

  friend bool operator==(const SolverSettings&, const SolverSettings&) = default;
};

}  // namespace trocar::tissue
