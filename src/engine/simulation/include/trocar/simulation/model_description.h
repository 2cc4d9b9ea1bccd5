// SPDX-License-Identifier: Apache-2.0
/// \file model_description.h  Constant data of a scene's tissue, in the rows of Snapshot: its surfaces, strands and vessels.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/roles/roles.h"
#include "trocar/scene/scene.h"
#include "trocar/scene/tissue_layout.h"

namespace trocar::simulation {

/// Knowledge of the patient before the operation, as from images and a textbook. Rows are those of Snapshot::positions.
struct ModelDescription {
  std::vector<scene::SurfaceInfo> surfaces;  ///< organs, then tubes, as Simulation::Surfaces()
  std::vector<scene::StrandInfo> strands;    ///< as Simulation::Strands()
  std::vector<math::Vec3> rest;              ///< (nodes) at rest, world frame [m]
  /// (tubes)(nodes of it) what the duct or artery is to the surgeon there; empty where they make no network
  std::vector<std::vector<roles::TubeRole>> tube_roles;
};

/// Compiles the scene's tissue as the simulation does, and keeps what is constant.
/// \return the error with which Simulation::Make refuses the scene's tissue
/// \note Not real-time safe: takes as long as making a simulation.
base::Result<ModelDescription> DescribeModel(const scene::Scene& scene);

}  // namespace trocar::simulation
