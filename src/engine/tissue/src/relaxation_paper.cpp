// SPDX-License-Identifier: Apache-2.0
/// \file relaxation_paper.cpp  The paper's solver (section 3.2.1), with the sign and the update of domain
/// facts 0b.4: for each node in turn, x_i <- x_i + alpha R_i, R_i = sum_j F_ij + m_i g + F_ext. The paper
/// ends after a time delta; here a count and a tolerance end it, so that results repeat.
#include <algorithm>
#include <cmath>

#include "node_balance.h"
#include "solver_content.h"

namespace trocar::tissue {

SolveReport SolveRelaxationPaper(const TissueModel& model, const IterationSettings& settings,
                                 const RelaxationSettings& relaxation, const TissueLoad& load,
                                 TissueState& state, ConstraintSet* constraints) noexcept {
  const auto n = static_cast<std::uint32_t>(model.Size());
  // half of the bound damps every mode of the linear system without oscillation
  const double alpha =
      relaxation.alpha > 0.0 ? relaxation.alpha : 0.5 * CalcLargestAlpha(model, load, state.position);
  SolveReport report;
  for (report.iterations = 0; report.iterations < settings.max_iterations;) {
    double largest = 0, scale = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (state.condition[i] == NodeCondition::kPrescribed) continue;
      const math::Vec3 residual = GatherNodeForce(model, state.strand_is_intact, load, state.position, i) +
                                  GatherContactForce(load, state.position, i);
      scale = math::Max(scale, CalcForceScale(model, load, state.position, i));
      largest = math::Max(largest, math::Norm(residual));
      state.position[i] += alpha * residual;
    }
    ++report.iterations;
    report.force_scale = scale;
    report.residual = scale > 0.0 ? largest / scale : 0.0;
    report.converged = report.residual <= settings.tolerance;
    if (constraints != nullptr && report.iterations % constraints->Interval() == 0)
      constraints->Project(state, {});
    if (report.converged) break;
  }
  return report;
}

}  // namespace trocar::tissue
