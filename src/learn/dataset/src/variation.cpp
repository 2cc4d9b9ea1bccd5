// SPDX-License-Identifier: Apache-2.0
#include "variation.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "trocar/math/random.h"

namespace trocar::dataset {

Variation DrawVariation(std::uint64_t seed) {
  math::Random random(seed);
  Variation v;
  v.light_power = random.Uniform(0.7, 1.35);
  v.field_of_view_scale = random.Uniform(0.93, 1.07);
  // most operations have little smoke most of the time
  v.smoke = 0.25 * std::max(0.0, random.Uniform(-1, 1));
  v.gains = {random.Uniform(0.94, 1.06), random.Uniform(0.94, 1.06), random.Uniform(0.90, 1.10)};
  v.gamma = random.Uniform(0.90, 1.12);
  v.tool_wear = random.Uniform(0.0, 1.6);
  // two of seven videos have one or two, where the picture is
  const int stains = static_cast<int>(std::max(0.0, std::floor(random.Uniform(-4, 3))));
  for (int i = 0; i < stains; ++i) {
    const double turn = random.Uniform(0, 2 * M_PI), far = 0.42 * std::sqrt(random.Uniform(0, 1));
    const double radius = random.Uniform(0.03, 0.10), thick = random.Uniform(0.15, 0.55);
    v.stains.push_back({{far * std::cos(turn), far * std::sin(turn)}, radius, thick});
  }
  return v;
}

nlohmann::ordered_json ToJson(const Variation& v) {
  nlohmann::ordered_json stains = nlohmann::ordered_json::array();
  for (const render::Blot& stain : v.stains)
    stains.push_back({stain.centre.x, stain.centre.y, stain.radius, stain.thick});
  return {{"light_power", v.light_power},
          {"field_of_view_scale", v.field_of_view_scale},
          {"smoke", v.smoke},
          {"gains", v.gains},
          {"gamma", v.gamma},
          {"tool_wear", v.tool_wear},
          {"stains", stains}};
}

ColourTable::ColourTable(const Variation& variation) {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    for (std::size_t value = 0; value < 256; ++value) {
      const double shown =
          255.0 * variation.gains[channel] * std::pow(static_cast<double>(value) / 255.0, variation.gamma);
      table_[channel][value] = static_cast<std::uint8_t>(std::lround(std::clamp(shown, 0.0, 255.0)));
    }
  }
}

void ColourTable::Apply(render::Image& image) const {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = table_[i % 3][image.pixels[i]];
}

}  // namespace trocar::dataset
