// SPDX-License-Identifier: Apache-2.0
/// \file vessel_map.h  The patient's ducts and arteries as a network with flow, and what each part of it is to the surgeon.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "trocar/scene/scene.h"
#include "trocar/surgery/flow_network.h"
#include "trocar/training/injury.h"

namespace trocar::simulation {

/// Place in the network.
struct VesselPlace {
  std::uint32_t vessel = 0;
  double position = 0;  ///< from the vessel's `from` end [m]
};

struct VesselMap {
  surgery::FlowNetwork network;
  training::BiliaryAnatomy anatomy;
  std::vector<std::vector<double>> arcs;  ///< (tubes)(points) length from the tube's first point [m]
  /// (tubes) the vessels along each, in the order of their points
  std::vector<std::vector<std::uint32_t>> vessels_of_tube;
  std::vector<std::vector<double>> starts;       ///< (tubes)(vessels of it) arc at which each begins [m]
  std::vector<std::uint32_t> gallbladder_ducts;  ///< junctions through which bile comes from the gallbladder

  /// \param arc  from the tube's first point [m]; outside is taken at the end
  VesselPlace Find(std::size_t tube, double arc) const;
};

/// Tubes are divided where others join them. What leaves the scene is fed by the aorta or drained by the bowel; what ends in
/// an organ belongs to it.
/// \return kPatientInvalid where the ducts make no network
core::Result<VesselMap> MakeVesselMap(const anatomy::Patient& patient);

}  // namespace trocar::simulation
