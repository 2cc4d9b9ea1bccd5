// SPDX-License-Identifier: Apache-2.0
/// \file conserved_equilibrium.h  The exact solution of the problem that a tick solves, as a reference for its error.
#pragma once

#include "trocar/tissue/conservation.h"

namespace trocar::tissue {

/// Goes on from where SolveConserving left a tick, to the equilibrium under the same loads, frames and volumes.
///
/// Volumes are kept, not pressures: a sac that snaps through at constant pressure can rest at constant volume.
///
/// \param exact  of kNewtonMultigrid; as deep as is asked
/// \param conservation  of the tick; nothing of it changes
/// \param load  as SolveConserving left it: its external_force holds frames and pressures
/// \param[in,out] tissue  of the tick, its conditions those of the solve
/// \param state  of the tick
/// \note Not real-time safe: copies the conservation.
SolveReport FindConservedEquilibrium(EquilibriumSolver& solver, const SolverSettings& exact,
                                     const Conservation& conservation, const TissueLoad& load,
                                     TissueState& tissue, const ConservationState& state);

}  // namespace trocar::tissue
