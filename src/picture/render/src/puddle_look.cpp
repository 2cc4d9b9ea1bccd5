// SPDX-License-Identifier: Apache-2.0
#include "puddle_look.h"

#include <algorithm>

#include "single_precision.h"

namespace trocar::render {

MaterialLook MixLook(const Looks& looks, const Puddle& puddle) {
  const std::array<Material, 3> liquids = {Material::kBlood, Material::kBile, Material::kRinse};
  const std::array<double, 3> amounts = {puddle.blood, puddle.bile, puddle.rinse};
  double all = 0, pigment = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    all += amounts[i];
    pigment += looks.pigment[i] * amounts[i];
  }
  MaterialLook mixed = looks[Material::kBlood];
  if (!(all > 0.0)) return mixed;
  mixed.low = mixed.high = {};
  mixed.opacity = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const MaterialLook& look = looks[liquids[i]];
    const float colour = ToFloat(looks.pigment[i] * amounts[i] / pigment);
    for (std::size_t k = 0; k < 3; ++k) {
      mixed.low[k] += colour * look.low[k];
      mixed.high[k] += colour * look.high[k];
    }
    mixed.opacity += ToFloat(amounts[i] / all) * look.opacity;
  }
  return mixed;
}

Material FindLiquid(const Looks& looks, const Puddle& puddle) {
  const std::array<double, 3> tints = {looks.pigment[0] * puddle.blood, looks.pigment[1] * puddle.bile,
                                       looks.pigment[2] * puddle.rinse};
  constexpr std::array<Material, 3> kLiquids = {Material::kBlood, Material::kBile, Material::kRinse};
  return kLiquids[static_cast<std::size_t>(std::max_element(tints.begin(), tints.end()) - tints.begin())];
}

}  // namespace trocar::render
