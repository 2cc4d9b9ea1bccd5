// SPDX-License-Identifier: Apache-2.0
/// \file patient_tissue.h  From a patient and its materials to one mass-spring system.
#pragma once

#include <vector>

#include "trocar/scene/scene.h"
#include "trocar/scene/tissue_layout.h"
#include "trocar/surgery/wall.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::scene {

struct PatientTissue {
  tissue::TissueDefinition definition;
  tissue::ConservationSettings
      conservation;                    ///< every organ keeps its volume; bed strands bind, tube ends turn
  std::vector<double> max_elongation;  ///< (strands) at which each tears [m]
  std::vector<std::int32_t>
      strand_organs;  ///< (strands) index into `surfaces` of what it holds; -1: connective tissue
  std::vector<std::int32_t> spring_organs;  ///< (walls' springs, which come first) index into Patient::organs
  std::vector<double> internal_pressure;    ///< (organs) under which each is filled at the start [Pa]
  std::vector<SurfaceInfo> surfaces;        ///< organs, then tubes
  std::vector<surgery::WallMaterial> walls;  ///< (organs) what a cut makes new springs from
  std::vector<StrandInfo> strands;           ///< (strands)
  std::vector<double>
      heat_mass;  ///< (nodes) of the layer that warms with each, an organ's skin or a tube's wall [kg]
  std::vector<std::uint32_t> first_spare;  ///< (organs) nodes for cuts; the last entry: for tubes
};

/// Nodes that cuts may use, see surgery::AddSpareNodes: after each organ's own, and at the end.
struct SpareNodes {
  std::uint32_t by_organ = 0;
  std::uint32_t tubes = 0;
};

/// Capacity that a solver keeps for cuts, as a share of springs and strands [-]: they go on in the same memory.
inline constexpr double kSpareShareForCuts = 0.5;

/// Nodes: every organ's vertices, then every tube's centre line. Springs: mesh edges by van Gelder, tubes
/// along their line with bending springs between next neighbours; virtual springs by Winkler; strands for the
/// bed and for the ends of tubes. Fixed: the paper's three regions of the liver and the tubes' ends that
/// leave the scene. The patient's diseases change materials and add adhesions (pathology.h).
///
/// \return kSceneInvalid when a material is missing, an organ is not closed, or there are too many
base::Result<PatientTissue> MakePatientTissue(const Scene& scene, const SpareNodes& spare = {});

}  // namespace trocar::scene
