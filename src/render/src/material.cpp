// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/material.h"

#include <cmath>
#include <cstddef>
#include <iterator>

#include "material_look.h"

namespace trocar::render {
namespace {

constexpr std::string_view kNames[] = {
    "liver",      "gallbladder",   "duct",         "artery",      "fat",           "bowel", "peritoneum",
    "shaft",      "steel",         "sleeve",       "force",       "fibre",         "film",  "blood",
    "bile",       "rinse",         "lumen",        "titanium",    "pouch",         "stone", "spark",
    "red_rubber", "yellow_rubber", "green_rubber", "blue_rubber", "white_plastic", "mark"};
static_assert(std::size(kNames) == static_cast<std::size_t>(Material::kCount));

/// Linear reflectance of an sRGB byte triple, as a colour picker on a photograph shows it.
Colour FromSrgb(int red, int green, int blue) {
  const auto linear = [](int byte) {
    const double value = byte / 255.0;
    return static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
  };
  return {linear(red), linear(green), linear(blue)};
}

std::array<MaterialLook, static_cast<std::size_t>(Material::kCount)> MakeLooks() {
  std::array<MaterialLook, static_cast<std::size_t>(Material::kCount)> looks;
  const auto look = [&looks](Material material) -> MaterialLook& {
    return looks[static_cast<std::size_t>(material)];
  };

  look(Material::kLiver) = {.low = FromSrgb(84, 28, 22),
                            .high = FromSrgb(136, 52, 38),
                            .cell = FromSrgb(150, 70, 50),
                            .vessel = FromSrgb(84, 24, 26),
                            .cell_amount = 0.26f,
                            .vessel_amount = 0.15f,
                            .vessel_width = 0.25f,
                            .detail_tile = {0.013f, 0.013f, 0.013f},
                            .broad_tile = 0.070f,
                            .bump_tile = 0.026f,
                            .bump = 0.16f,
                            .wet = 0.55f,
                            .wet_exponent = 260,
                            .sheen = 0.06f,
                            .wrap = {0.22f, 0.10f, 0.08f},
                            .glow = 0.0f};
  look(Material::kGallbladder) = {.low = FromSrgb(92, 116, 100),
                                  .high = FromSrgb(160, 156, 112),
                                  .cell = FromSrgb(176, 166, 126),
                                  .vessel = FromSrgb(132, 44, 38),
                                  .cell_amount = 0.10f,
                                  .vessel_amount = 0.75f,
                                  .vessel_width = 0.20f,
                                  .detail_tile = {0.020f, 0.020f, 0.020f},
                                  .broad_tile = 0.042f,
                                  .bump_tile = 0.030f,
                                  .bump = 0.10f,
                                  .wet = 0.75f,
                                  .wet_exponent = 320,
                                  .sheen = 0.09f,
                                  .wrap = {0.30f, 0.30f, 0.22f},
                                  .glow = 0.18f};
  look(Material::kDuct) = {.low = FromSrgb(158, 152, 92),
                           .high = FromSrgb(196, 188, 128),
                           .cell = FromSrgb(206, 196, 150),
                           .vessel = FromSrgb(170, 84, 60),
                           .cell_amount = 0.20f,
                           .vessel_amount = 0.35f,
                           .vessel_width = 0.22f,
                           .detail_tile = {0.012f, 0.012f, 0.012f},
                           .broad_tile = 0.030f,
                           .bump_tile = 0.018f,
                           .bump = 0.12f,
                           .wet = 0.6f,
                           .wet_exponent = 220,
                           .sheen = 0.08f,
                           .wrap = {0.30f, 0.28f, 0.18f},
                           .glow = 0.20f};
  look(Material::kArtery) = {.low = FromSrgb(160, 44, 38),
                             .high = FromSrgb(196, 84, 70),
                             .cell = FromSrgb(206, 120, 104),
                             .vessel = FromSrgb(130, 30, 30),
                             .cell_amount = 0.20f,
                             .vessel_amount = 0.2f,
                             .vessel_width = 0.2f,
                             .detail_tile = {0.010f, 0.010f, 0.010f},
                             .broad_tile = 0.030f,
                             .bump_tile = 0.016f,
                             .bump = 0.10f,
                             .wet = 0.6f,
                             .wet_exponent = 220,
                             .sheen = 0.08f,
                             .wrap = {0.30f, 0.14f, 0.12f},
                             .glow = 0.15f};
  look(Material::kFat) = {.low = FromSrgb(200, 136, 64),
                          .high = FromSrgb(238, 200, 122),
                          .cell = FromSrgb(196, 104, 54),
                          .vessel = FromSrgb(164, 42, 34),
                          .cell_amount = 0.40f,
                          .vessel_amount = 0.70f,
                          .vessel_width = 0.15f,
                          .detail_tile = {0.034f, 0.034f, 0.034f},
                          .broad_tile = 0.075f,
                          .bump_tile = 0.030f,
                          .bump = 0.34f,
                          .wet = 0.45f,
                          .wet_exponent = 150,
                          .sheen = 0.10f,
                          .wrap = {0.34f, 0.24f, 0.10f},
                          .glow = 0.0f};
  look(Material::kBowel) = {.low = FromSrgb(196, 118, 98),
                            .high = FromSrgb(226, 164, 138),
                            .cell = FromSrgb(214, 136, 112),
                            .vessel = FromSrgb(168, 48, 46),
                            .cell_amount = 0.15f,
                            .vessel_amount = 0.65f,
                            .vessel_width = 0.16f,
                            .detail_tile = {0.030f, 0.030f, 0.030f},
                            .broad_tile = 0.060f,
                            .bump_tile = 0.040f,
                            .bump = 0.12f,
                            .wet = 0.55f,
                            .wet_exponent = 200,
                            .sheen = 0.08f,
                            .wrap = {0.30f, 0.18f, 0.14f},
                            .glow = 0.0f};
  look(Material::kPeritoneum) = {.low = FromSrgb(178, 84, 68),
                                 .high = FromSrgb(234, 170, 134),
                                 .cell = FromSrgb(236, 186, 150),
                                 .vessel = FromSrgb(132, 34, 34),
                                 .cell_amount = 0.25f,
                                 .vessel_amount = 0.55f,
                                 .vessel_width = 0.12f,
                                 .detail_tile = {0.190f, 0.034f, 0.110f},
                                 .broad_tile = 0.150f,
                                 .bump_tile = 0.060f,
                                 .bump = 0.16f,
                                 .wet = 0.25f,
                                 .wet_exponent = 120,
                                 .sheen = 0.06f,
                                 .wrap = {0.25f, 0.16f, 0.12f},
                                 .glow = 0.0f};
  look(Material::kShaft) = {.is_tissue = false,
                            .low = FromSrgb(10, 10, 11),
                            .high = FromSrgb(22, 22, 25),
                            .wet = 0.10f,
                            .wet_exponent = 60,
                            .sheen = 0.03f};
  look(Material::kSteel) = {.is_tissue = false,
                            .low = FromSrgb(52, 54, 58),
                            .high = FromSrgb(122, 124, 130),
                            .wet = 0.9f,
                            .wet_exponent = 90,
                            .sheen = 0.30f,
                            .grooves = 0.08f};
  look(Material::kSleeve) = {.is_tissue = false,
                             .low = FromSrgb(92, 98, 104),
                             .high = FromSrgb(176, 184, 190),
                             .wet = 0.25f,
                             .wet_exponent = 40,
                             .sheen = 0.10f};
  look(Material::kForce) = {.is_tissue = false,
                            .low = FromSrgb(24, 128, 220),
                            .high = FromSrgb(40, 170, 255),
                            .wet = 0.1f,
                            .wet_exponent = 30,
                            .sheen = 0.05f};
  look(Material::kFibre) = {
      .low = FromSrgb(176, 150, 118), .high = FromSrgb(222, 206, 180), .wet = 0.20f, .opacity = 0.50f};
  look(Material::kFilm) = {.low = FromSrgb(214, 188, 158),
                           .high = FromSrgb(240, 222, 196),
                           .wet = 0.9f,
                           .wet_exponent = 160,
                           .sheen = 0.12f,
                           .opacity = 0.20f};
  look(Material::kBlood) = {.low = FromSrgb(74, 4, 6),
                            .high = FromSrgb(122, 10, 11),
                            .wet = 0.9f,
                            .wet_exponent = 240,
                            .sheen = 0.002f,
                            .opacity = 0.93f};
  look(Material::kBile) = {.low = FromSrgb(126, 116, 22),
                           .high = FromSrgb(168, 150, 34),
                           .wet = 0.9f,
                           .wet_exponent = 240,
                           .sheen = 0.002f,
                           .opacity = 0.80f};
  look(Material::kRinse) = {.low = FromSrgb(196, 190, 178),
                            .high = FromSrgb(214, 210, 200),
                            .wet = 0.9f,
                            .wet_exponent = 260,
                            .sheen = 0.002f,
                            .opacity = 0.16f};
  look(Material::kLumen) = {.is_tissue = false,
                            .low = FromSrgb(14, 3, 3),
                            .high = FromSrgb(30, 7, 6),
                            .wet = 0.05f,
                            .wet_exponent = 60,
                            .sheen = 0.0f};
  look(Material::kTitanium) = {.is_tissue = false,
                               .low = FromSrgb(96, 96, 102),
                               .high = FromSrgb(196, 196, 204),
                               .wet = 0.9f,
                               .wet_exponent = 70,
                               .sheen = 0.34f};
  look(Material::kPouch) = {.low = FromSrgb(176, 196, 214),
                            .high = FromSrgb(206, 220, 232),
                            .wet = 0.7f,
                            .wet_exponent = 180,
                            .sheen = 0.04f,
                            .opacity = 0.28f};
  look(Material::kStone) = {.low = FromSrgb(104, 74, 30),
                            .high = FromSrgb(206, 168, 92),
                            .cell = FromSrgb(80, 54, 24),
                            .cell_amount = 0.22f,
                            .vessel_amount = 0.0f,
                            .detail_tile = {0.006f, 0.006f, 0.006f},
                            .broad_tile = 0.008f,
                            .bump_tile = 0.006f,
                            .bump = 0.16f,
                            .wet = 0.35f,
                            .wet_exponent = 110,
                            .sheen = 0.08f};
  look(Material::kSpark) = {
      .low = FromSrgb(190, 214, 255), .high = FromSrgb(255, 252, 255), .emission = 6.0f};
  const auto rubber = [&](Material material, const Colour& low, const Colour& high) {
    look(material) = {
        .is_tissue = false, .low = low, .high = high, .wet = 0.12f, .wet_exponent = 30, .sheen = 0.08f};
  };
  rubber(Material::kRedRubber, FromSrgb(112, 20, 18), FromSrgb(206, 52, 44));
  rubber(Material::kYellowRubber, FromSrgb(140, 104, 16), FromSrgb(236, 190, 48));
  rubber(Material::kGreenRubber, FromSrgb(20, 84, 40), FromSrgb(54, 160, 84));
  rubber(Material::kBlueRubber, FromSrgb(18, 48, 112), FromSrgb(50, 104, 200));
  rubber(Material::kWhitePlastic, FromSrgb(150, 148, 142), FromSrgb(226, 224, 216));
  rubber(Material::kMark, FromSrgb(60, 200, 90), FromSrgb(130, 255, 150));
  return looks;
}

}  // namespace

std::string_view MaterialName(Material material) noexcept {
  return kNames[static_cast<std::size_t>(material)];
}

std::optional<Material> FindMaterial(std::string_view name) noexcept {
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    if (kNames[i] == name) return static_cast<Material>(i);
  }
  return std::nullopt;
}

const MaterialLook& GetLook(Material material) noexcept {
  static const auto looks = MakeLooks();
  return looks[static_cast<std::size_t>(material)];
}

}  // namespace trocar::render
