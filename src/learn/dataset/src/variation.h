// SPDX-License-Identifier: Apache-2.0
/// \file variation.h  How the picture of one video differs from that of another: what an endoscope, its lamp and its
/// camera's settings change.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "trocar/render/frame.h"
#include "trocar/render/image.h"

namespace trocar::dataset {

/// The defaults change nothing.
struct Variation {
  double light_power = 1;                ///< of the head light [-]
  double field_of_view_scale = 1;        ///< of the lens [-]
  double smoke = 0;                      ///< haze that is always there, 0 to 1 [-]
  std::array<double, 3> gains{1, 1, 1};  ///< of red, green and blue: the camera's white balance [-]
  double gamma = 1;                      ///< of the camera [-]
  double tool_wear = 1;                  ///< scratches of tools, in the usual ones [-]
  std::vector<render::Blot> stains;      ///< on the lens
};

Variation DrawVariation(std::uint64_t seed);
nlohmann::ordered_json ToJson(const Variation& variation);

/// Colour response of the camera: gains and gamma, as a lookup table.
class ColourTable {
 public:
  explicit ColourTable(const Variation& variation);
  void Apply(render::Image& image) const;

 private:
  std::array<std::array<std::uint8_t, 256>, 3> table_;
};

}  // namespace trocar::dataset
