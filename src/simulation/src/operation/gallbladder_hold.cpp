// SPDX-License-Identifier: Apache-2.0
#include "operation/gallbladder_hold.h"

#include <algorithm>

namespace trocar::simulation {

GallbladderHold::GallbladderHold(const anatomy::Patient& patient, std::span<const SurfaceInfo> surfaces,
                                 std::span<const StrandInfo> strands) {
  using Kind = StrandInfo::Kind;
  const bool has_axis =
      patient.FindLandmark("fundus") != nullptr && patient.FindLandmark("infundibulum") != nullptr;
  for (std::uint32_t i = 0; i < strands.size(); ++i) {
    if (strands[i].kind == Kind::kAdhesion || (strands[i].kind == Kind::kBed && has_axis))
      strands_.push_back(i);
  }
  const int gallbladder = patient.FindOrgan("gallbladder");
  if (gallbladder < 0) return;
  const SurfaceInfo& organ = surfaces[static_cast<std::size_t>(gallbladder)];
  for (std::uint32_t t = 0; t < patient.tubes.size(); ++t) {
    const anatomy::Tube& tube = patient.tubes[t];
    // one that only grazes the bed, Luschka's duct, is divided with the bed
    if (tube.from != "gallbladder" && tube.to != "gallbladder") continue;
    const SurfaceInfo& surface = surfaces[patient.organs.size() + t];
    const std::uint32_t end = surface.first_node + (tube.to == "gallbladder" ? surface.node_count - 1 : 0);
    Entering entering{t, {}};
    for (std::uint32_t i = 0; i < strands.size(); ++i) {
      if (strands[i].kind == Kind::kEnd && strands[i].a == end && strands[i].b >= organ.first_node &&
          strands[i].b < organ.first_node + organ.node_count)
        entering.end_strands.push_back(i);
    }
    entering_.push_back(std::move(entering));
  }
}

bool GallbladderHold::IsFree(const tissue::TissueState& tissue, const VesselWork& vessels) const noexcept {
  const auto is_intact = [&](std::uint32_t strand) { return tissue.strand_is_intact[strand] != 0; };
  return std::none_of(strands_.begin(), strands_.end(), is_intact) &&
         std::none_of(entering_.begin(), entering_.end(), [&](const Entering& tube) {
           return vessels.CountCuts(tube.tube) == 0 &&
                  std::any_of(tube.end_strands.begin(), tube.end_strands.end(), is_intact);
         });
}

}  // namespace trocar::simulation
