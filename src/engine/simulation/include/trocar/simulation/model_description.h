// SPDX-License-Identifier: Apache-2.0
/// \file model_description.h  Constant data of a scene's tissue, in the rows of Snapshot: its surfaces, strands and vessels.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/cholecystectomy/triangle_sight.h"
#include "trocar/scene/scene.h"
#include "trocar/scene/tissue_layout.h"

namespace trocar::simulation {

/// Knowledge of the patient before the operation, as from images and a textbook. Rows are those of Snapshot::positions.
struct ModelDescription {
  std::vector<scene::SurfaceInfo> surfaces;  ///< organs, then tubes, as Simulation::Surfaces()
  std::vector<scene::StrandInfo> strands;    ///< as Simulation::Strands()
  std::vector<math::Vec3> rest;              ///< (nodes) at rest, world frame [m]
  /// (tubes)(nodes of it) what the duct or artery is to the surgeon there; empty where they make no network
  std::vector<std::vector<cholecystectomy::VesselRole>> tube_roles;
  /// Of an operation: strands of fat and peritoneum over the window of the hepatocystic triangle.
  std::vector<std::uint32_t> window_strands;
  cholecystectomy::TriangleSight sight;  ///< of an operation: of the triangle
  /// (tubes) Of an operation: what may be asked to lie bare of each that enters the gallbladder, from there on, along it at
  /// rest [m]; 0 for the others.
  std::vector<double> exposable;
};

/// Compiles the scene's tissue as the simulation does, and keeps what is constant.
/// \return the error with which Simulation::Make refuses the scene's tissue
/// \note Not real-time safe: takes as long as making a simulation.
base::Result<ModelDescription> DescribeModel(const scene::Scene& scene);

}  // namespace trocar::simulation
