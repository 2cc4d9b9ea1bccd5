// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/vessel_judgement.h"

#include <algorithm>

namespace trocar::cholecystectomy {
namespace {

constexpr double kTightClip = 0.999;  // closure of a clip that lets nothing through [-]

}  // namespace

VesselJudgement JudgePlace(const scene::VesselAnatomy& anatomy, const surgery::Vessels& vessels,
                           const surgery::TubePlace& place) noexcept {
  const surgery::VesselMap& map = vessels.Map();
  const surgery::VesselPlace at = map.Find(place.tube, place.arc);
  const auto& junctions = anatomy.hollow_organ;
  const bool is_gallbladder_at_from =
      std::find(junctions.begin(), junctions.end(), map.network.Vessels()[at.vessel].from) != junctions.end();
  const auto stays = [&](const surgery::VesselClip& clip) {
    return clip.vessel == at.vessel && clip.closure >= kTightClip &&
           (clip.position > at.position) == is_gallbladder_at_from;
  };
  const auto& clips = vessels.Acts().clips;
  return {MayBeDivided(anatomy.roles[at.vessel]),
          static_cast<int>(std::count_if(clips.begin(), clips.end(), stays)), vessels.CountCuts(place.tube)};
}

}  // namespace trocar::cholecystectomy
