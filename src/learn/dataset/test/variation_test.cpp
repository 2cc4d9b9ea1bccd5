// SPDX-License-Identifier: Apache-2.0
#include "variation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace trocar::dataset {
namespace {

TEST(Variation, IsDrawnByTheSeedWithinItsRanges) {
  std::set<std::string> all;
  int stained = 0;
  for (std::uint64_t seed = 1; seed <= 700; ++seed) {
    const Variation v = DrawVariation(seed);
    const std::string text = ToJson(v).dump();
    EXPECT_EQ(text, ToJson(DrawVariation(seed)).dump());
    all.insert(text);
    EXPECT_TRUE(v.light_power >= 0.7 && v.light_power <= 1.35);
    EXPECT_TRUE(v.smoke >= 0 && v.smoke <= 0.25);
    EXPECT_TRUE(v.tool_wear >= 0 && v.tool_wear <= 1.6);
    EXPECT_LE(v.stains.size(), 2U);
    for (const render::Blot& stain : v.stains) {
      EXPECT_LE(std::hypot(stain.centre.x, stain.centre.y), 0.42);
      EXPECT_TRUE(stain.radius >= 0.03 && stain.radius <= 0.10);
      EXPECT_TRUE(stain.thick >= 0.15 && stain.thick <= 0.55);
    }
    stained += v.stains.empty() ? 0 : 1;
  }
  EXPECT_EQ(all.size(), 700U);
  // two of seven, within four standard deviations
  EXPECT_NEAR(stained, 200, 48);
}

TEST(Variation, TheUsualOneChangesNoPixel) {
  render::Image image{2, 1, {0, 1, 100, 254, 255, 128}};
  const render::Image before = image;
  ColourTable(Variation{}).Apply(image);
  EXPECT_EQ(image, before);
  EXPECT_TRUE(Variation{}.stains.empty());
  EXPECT_EQ(Variation{}.tool_wear, 1);
}

}  // namespace
}  // namespace trocar::dataset
