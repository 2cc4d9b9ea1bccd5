// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/damage.h"

#include <algorithm>

#include "trocar/core/assert.h"

namespace trocar::tissue {

std::size_t TearStrands(const TissueModel& model, std::span<const double> max_elongation, TissueState& state,
                        std::span<std::uint32_t> torn) noexcept {
  TROCAR_ASSERT(max_elongation.size() == model.strand_count);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      const auto& half = model.half_strands[h];
      if (half.other < i || !state.strand_is_intact[half.strand]) continue;
      const double elongation = math::Distance(state.position[half.other], state.position[i]) -
                                math::Distance(model.rest[half.other], model.rest[i]);
      if (!(elongation > max_elongation[half.strand])) continue;
      state.strand_is_intact[half.strand] = 0;
      if (count < torn.size()) torn[count] = half.strand;
      ++count;
    }
  }
  std::sort(torn.begin(), torn.begin() + static_cast<std::ptrdiff_t>(std::min(count, torn.size())));
  return count;
}

}  // namespace trocar::tissue
