// SPDX-License-Identifier: Apache-2.0
/// \file vessel_map.h  Ducts and arteries as a network with flow, and where along each tube its vessels lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "trocar/surgery/flow_network.h"

namespace trocar::surgery {

/// Place in the network.
struct VesselPlace {
  std::uint32_t vessel = 0;
  double position = 0;  ///< from the vessel's `from` end [m]
};

/// Tubes are divided into vessels where others join them.
struct VesselMap {
  FlowNetwork network;
  std::vector<std::vector<double>> arcs;  ///< (tubes)(points) length from the tube's first point [m]
  /// (tubes) the vessels along each, in the order of their points
  std::vector<std::vector<std::uint32_t>> vessels_of_tube;
  std::vector<std::vector<double>> starts;  ///< (tubes)(vessels of it) arc at which each begins [m]
  std::vector<std::uint32_t> organ_ducts;   ///< junctions through which bile comes from a hollow organ

  /// \param arc  from the tube's first point [m]; outside is taken at the end
  VesselPlace Find(std::size_t tube, double arc) const;
};

}  // namespace trocar::surgery
