// SPDX-License-Identifier: Apache-2.0
#include "bad_tick.h"

#include <algorithm>
#include <array>

#include "trocar/base/assert.h"

namespace trocar::simulation {

void TakeBack(const tissue::ConservationTick& good, tissue::ConservationTick& state) noexcept {
  TROCAR_ASSERT(good.organs.size() == state.organs.size() && good.organs.size() <= tissue::kMaxClosedOrgans);
  std::array<double, tissue::kMaxClosedOrgans> opening_areas{};
  for (std::size_t i = 0; i < state.organs.size(); ++i) opening_areas[i] = state.organs[i].opening_area;
  state = good;
  for (std::size_t i = 0; i < state.organs.size(); ++i)
    state.organs[i].opening_area = std::max(state.organs[i].opening_area, opening_areas[i]);
}

}  // namespace trocar::simulation
