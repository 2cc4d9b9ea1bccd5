// SPDX-License-Identifier: Apache-2.0
/// \file model_check.h  Models from outside: what cannot be solved is named, what can be put right is put
/// right and said.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "trocar/base/result.h"
#include "trocar/tissue/solver_settings.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::tissue {

/// Repairs that CheckTissue made.
struct TissueRepairs {
  std::size_t merged_springs = 0;  ///< second springs between two nodes, joined with the first
  std::size_t held_nodes = 0;  ///< nodes that nothing holds: no spring, strand or virtual spring; now fixed
  /// One line for a person; empty where nothing was done.
  std::string Text() const;
};

/// Checks a system before MakeTissueModel, which asserts what this reports.
///
/// Put right: two springs between the same nodes become the one that exerts the same force, k = k1 + k2,
/// k l = k1 l1 + k2 l2; a node that nothing holds is fixed, because it has no equilibrium.
///
/// \param[in,out] definition
/// \param memory_bytes  memory that model and solvers may take, out of that found by the program
/// \return kTissueInvalid: sizes that differ, an index out of range, a link from a node to itself, a number
/// that is
///         negative or not finite, a spring whose ends lie in one point at rest although its length is not
///         zero; kOutOfMemory
base::Result<TissueRepairs> CheckTissue(TissueDefinition& definition, std::size_t memory_bytes = SIZE_MAX);

/// Memory of a model and an EquilibriumSolver, estimated from above [bytes].
std::size_t CalcTissueMemory(const TissueDefinition& definition) noexcept;

/// \return kUnstableStep where settings.relaxation.alpha is beyond what any state of the model bears, naming the largest
/// that is
///         not (CalcLargestAlpha); only the relaxation takes an alpha
base::Status CheckSolverSettings(const SolverSettings& settings, const TissueModel& model,
                                 const TissueLoad& load);

}  // namespace trocar::tissue
