// SPDX-License-Identifier: Apache-2.0
/// \file simulation_model.h  Constant data of a surgery, shared by any number of simulations.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "topology.h"
#include "trocar/scene/patient_tissue.h"
#include "trocar/simulation/simulation.h"
#include "trocar/tissue/conservation.h"

namespace trocar::simulation {

/// Gravity in which the organs were imaged: the body lay on its back [m/s^2].
inline constexpr math::Vec3 kImagingGravity{0, 0, -9.81};

struct SimulationModel {
  std::shared_ptr<const scene::Scene> scene;
  std::shared_ptr<const scene::PatientTissue> tissue;  ///< before any cut
  WallSprings walls;
  bool walls_tear = false;
  std::int32_t hollow_organ = -1;       ///< leaks when its wall tears
  tissue::TissueState tissue_at_start;  ///< at rest, tense organs filled
  tissue::ConservationState conserved_at_start;
  std::uint64_t fingerprint = 0;        ///< of all that makes a state one of this model
  std::uint64_t first_fingerprint = 0;  ///< as it was taken at first, see ModelFingerprintKind
  /// Solver model of the uncut tissue.
  std::shared_ptr<const tissue::SolverModel> solver_model;
  /// State of the first tick. The first simulation of the model saves it: it is the same in all of them.
  mutable std::vector<std::byte> start;
  mutable std::once_flag has_start;
};

}  // namespace trocar::simulation
