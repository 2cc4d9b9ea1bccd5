// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/solver_settings.h"

namespace trocar::tissue {

std::string_view SolverName(SolverKind kind) noexcept {
  return kind == SolverKind::kRelaxationPaper ? "relaxation" : "chebyshev";
}

}  // namespace trocar::tissue
