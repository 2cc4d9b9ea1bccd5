// SPDX-License-Identifier: Apache-2.0
/// \file gallbladder_hold.h  What still holds the gallbladder: bed, adhesions, and the tubes that enter it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "operation/vessel_work.h"
#include "trocar/simulation/simulation.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::simulation {

/// Constant.
class GallbladderHold {
 public:
  GallbladderHold() = default;
  /// \param surfaces  organs, then tubes
  /// \param strands   (strands)
  GallbladderHold(const anatomy::Patient& patient, std::span<const SurfaceInfo> surfaces,
                  std::span<const StrandInfo> strands);

  /// Neither bed nor adhesion holds it, and no tube that enters it is whole.
  /// \note Real-time safe.
  bool IsFree(const tissue::TissueState& tissue, const VesselWork& vessels) const noexcept;

 private:
  struct Entering {
    std::uint32_t tube = 0;
    std::vector<std::uint32_t> end_strands;  // that tie it to the gallbladder
  };
  std::vector<std::uint32_t> strands_;  // of bed and adhesions
  std::vector<Entering> entering_;
};

}  // namespace trocar::simulation
