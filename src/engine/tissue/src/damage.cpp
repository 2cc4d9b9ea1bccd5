// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/damage.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/math/elementary.h"
#include "trocar/tissue/spring_law.h"

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

bool HasTearingSprings(const TissueModel& model) noexcept {
  return std::any_of(model.laws.begin(), model.laws.end(),
                     [](const SpringLaw& law) { return std::isfinite(law.failure_strain); });
}

std::size_t TearSprings(const TissueModel& model, double dt, TissueState& state,
                        std::span<std::uint32_t> torn) noexcept {
  TROCAR_ASSERT(state.spring_factor.size() == model.SpringCount() &&
                state.spring_damage.size() == model.SpringCount());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      const SpringLaw& law = model.laws[model.spring_law[half.spring]];
      if (half.other < i || !std::isfinite(law.failure_strain) || state.spring_factor[half.spring] == 0.0)
        continue;
      const double length = math::Distance(state.position[half.other], state.position[i]);
      const double longest = half.rest_length * (1.0 + law.failure_strain);
      double& damage = state.spring_damage[half.spring];
      if (law.damage_rate > 0.0 && length > half.rest_length && longest > half.rest_length) {
        // the same stiffness and factor on both sides: what is left of a spring carries what is left of its load
        const double share = CalcSpringTension(law, 1.0, half.rest_length, length) /
                             CalcSpringTension(law, 1.0, half.rest_length, longest);
        damage += law.damage_rate * math::Pow(share, law.damage_exponent) * dt;
      }
      if (!(length > longest || damage >= 1.0)) continue;
      state.spring_factor[half.spring] = 0.0;
      if (count < torn.size()) torn[count] = half.spring;
      ++count;
    }
  }
  std::sort(torn.begin(), torn.begin() + static_cast<std::ptrdiff_t>(std::min(count, torn.size())));
  return count;
}

}  // namespace trocar::tissue
