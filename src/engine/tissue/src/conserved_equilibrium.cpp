// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/conserved_equilibrium.h"

#include <vector>

#include "volume_constraint_set.h"

namespace trocar::tissue {

SolveReport FindConservedEquilibrium(EquilibriumSolver& solver, const SolverSettings& exact,
                                     const Conservation& conservation, const TissueLoad& load,
                                     TissueState& tissue, const ConservationState& state) {
  Conservation kept = conservation;
  ConservationState moved = state;
  // all but the pressures stays as it was in the tick: CalcForce adds only them where it knows of no frame
  moved.regions.count = 0;
  std::vector<math::Vec3> without_pressure(load.external_force.begin(), load.external_force.end());
  for (std::size_t organ = 0; organ < state.organs.size() && !without_pressure.empty(); ++organ) {
    const auto [first, count] = conservation.OrganNodes()[organ];
    for (std::uint32_t i = first; i < first + count; ++i)
      without_pressure[i] -= state.organs[organ].pressure * conservation.VolumeGradient()[i];
  }
  TissueLoad loaded = load;
  loaded.external_force = without_pressure;
  loaded.external_force = kept.CalcForce(tissue, loaded, moved);
  VolumeConstraintSet constraints(kept, moved);
  return solver.Solve(exact, loaded, tissue, &constraints);
}

}  // namespace trocar::tissue
