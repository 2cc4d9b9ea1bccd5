// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/organ_attachment.h"

#include <algorithm>

namespace trocar::surgery {

bool OrganAttachment::IsFree(const tissue::TissueState& tissue, const Vessels& vessels) const noexcept {
  const auto is_intact = [&](std::uint32_t strand) { return tissue.strand_is_intact[strand] != 0; };
  return std::none_of(strands_.begin(), strands_.end(), is_intact) &&
         std::none_of(entering_.begin(), entering_.end(), [&](const EnteringTube& tube) {
           return vessels.CountCuts(tube.tube) == 0 &&
                  std::any_of(tube.end_strands.begin(), tube.end_strands.end(), is_intact);
         });
}

}  // namespace trocar::surgery
