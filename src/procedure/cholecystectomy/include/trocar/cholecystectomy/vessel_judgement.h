// SPDX-License-Identifier: Apache-2.0
/// \file vessel_judgement.h  Whether a duct or artery may be divided at a place, and whether what stays is closed there.
#pragma once

#include <cstddef>

#include "trocar/cholecystectomy/injury.h"
#include "trocar/surgery/vessels.h"

namespace trocar::cholecystectomy {

/// Judgement of a place of a duct or vessel, for an act there.
struct VesselJudgement {
  bool may_be_divided = false;
  int staying_clips = 0;  ///< tight ones between the place and the side that stays
  std::size_t cuts = 0;   ///< through the whole tube, so far
};

/// The side that stays is the one that joins another tube, or comes from the liver.
/// \param anatomy  of the same vessels
/// \note Real-time safe.
VesselJudgement JudgePlace(const scene::VesselAnatomy& anatomy, const surgery::Vessels& vessels,
                           const surgery::TubePlace& place) noexcept;

}  // namespace trocar::cholecystectomy
