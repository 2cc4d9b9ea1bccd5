// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/entering_tubes.h"

#include <algorithm>
#include <utility>

namespace trocar::scene {

std::vector<std::uint32_t> ListNodesFrom(const SurfaceInfo& tube, std::int32_t organ) {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t k = 0; k < tube.node_count; ++k) nodes.push_back(tube.first_node + k);
  if (organ >= 0 && tube.ends[1] == organ) std::reverse(nodes.begin(), nodes.end());
  return nodes;
}

std::vector<surgery::EnteringTube> FindEnteringTubes(std::span<const SurfaceInfo> surfaces,
                                                     std::span<const StrandInfo> strands,
                                                     std::int32_t organ) {
  std::vector<surgery::EnteringTube> found;
  if (organ < 0) return found;
  const SurfaceInfo& entered = surfaces[static_cast<std::size_t>(organ)];
  std::uint32_t t = 0;
  for (const SurfaceInfo& tube : surfaces) {
    if (!tube.IsTube()) continue;
    const std::uint32_t number = t++;
    // one that only grazes the bed, Luschka's duct, is divided with the bed
    if (!tube.Joins(organ)) continue;
    surgery::EnteringTube entering{number, ListNodesFrom(tube, organ), {}};
    for (std::uint32_t i = 0; i < strands.size(); ++i) {
      const StrandInfo& strand = strands[i];
      if (strand.kind == StrandInfo::Kind::kEnd && strand.a == entering.nodes.front() &&
          strand.b >= entered.first_node && strand.b < entered.first_node + entered.node_count)
        entering.end_strands.push_back(i);
    }
    found.push_back(std::move(entering));
  }
  return found;
}

}  // namespace trocar::scene
