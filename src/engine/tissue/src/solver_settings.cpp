// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/solver_settings.h"

namespace trocar::tissue {

std::string_view SolverName(SolverKind kind) noexcept {
  switch (kind) {
    case SolverKind::kRelaxationPaper:
      return "relaxation";
    case SolverKind::kGaussSeidelBrown2001:
      return "gauss_seidel";
    case SolverKind::kChebyshevJacobi2015:
      return "chebyshev";
    case SolverKind::kAcceleratedDescent:
      return "accelerated";
    case SolverKind::kNewtonMultigrid:
      return "newton";
    case SolverKind::kAdaptive:
      return "adaptive";
  }
  return "";
}

std::optional<SolverKind> FindSolverKind(std::string_view name) noexcept {
  for (const SolverKind kind : kSolverKinds) {
    if (SolverName(kind) == name) return kind;
  }
  return std::nullopt;
}

}  // namespace trocar::tissue
