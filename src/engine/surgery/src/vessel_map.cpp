// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/vessel_map.h"

#include <algorithm>

namespace trocar::surgery {

VesselPlace VesselMap::Find(std::size_t tube, double arc) const {
  const auto& own = vessels_of_tube[tube];
  std::size_t i = 0;
  while (i + 1 < own.size() && starts[tube][i + 1] <= arc) ++i;
  const double length = network.Vessels()[own[i]].length;
  return {own[i], std::clamp(arc - starts[tube][i], 0.0, length)};
}

}  // namespace trocar::surgery
