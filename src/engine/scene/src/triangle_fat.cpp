// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/triangle_fat.h"

#include <cstdint>
#include <vector>

namespace trocar::scene {

surgery::FatLobules MakeTriangleFat(std::span<const StrandInfo> strands, std::span<const math::Vec3> rest) {
  std::vector<surgery::FatStrand> fat;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind == StrandInfo::Kind::kTriangle) fat.push_back({i, strands[i].a, strands[i].b});
  }
  return {fat, rest, kLobuleRadius};
}

}  // namespace trocar::scene
