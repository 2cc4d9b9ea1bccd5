// SPDX-License-Identifier: Apache-2.0
/// \file looks.h  Looks of the laparoscope's picture, read from a file: light, smoke, liquids and the surface of every material.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>

#include "trocar/base/result.h"
#include "trocar/math/vector.h"
#include "trocar/render/material.h"

namespace trocar::render {

using Colour = std::array<float, 3>;

/// Parameters of the two shaders for one material. Colours are linear (not sRGB) reflectances in [0, 1].
struct MaterialLook {
  bool is_tissue = true;      ///< false: the shader of tools
  Colour low{}, high{};       ///< between these by smooth noise
  Colour cell{};              ///< along the borders of lobules (tissue)
  Colour vessel{};            ///< of the vessel network (tissue)
  float cell_amount = 0;      ///< [-]
  float vessel_amount = 0;    ///< [-]
  float vessel_width = 0.5f;  ///< [-] of the ridge value
  Colour detail_tile{};       ///< edge of the noise tile along rest x, y, z [m]; unequal edges make stripes
  float broad_tile = 0.08f;   ///< of the slow variation and the vessels [m]
  float bump_tile = 0.03f;    ///< of the bumps [m]
  float bump = 0;             ///< how far they tilt the normal [-]
  float wet = 0;              ///< of the sharp highlight [-]
  float wet_exponent = 200;   ///< [-]
  float sheen = 0;            ///< of the broad highlight [-]
  Colour wrap{};              ///< light that goes round into the shade, per colour [-]
  float glow = 0;             ///< light that comes through a thin wall at its rim [-]
  float grooves = 0;          ///< depth of fine grooves across the shaft (tools) [-]
  float wear = 0;             ///< scratches and rubbed places (tools) [-]
  float line_tile = 0;        ///< between printed lines, along rest x, y, z (even tools) [m]; 0: none
  float lines = 0;            ///< how dark these lines are [-]
  float opacity = 1;          ///< below 1: light passes through, seen square on [-]
  float emission = 0;         ///< light of its own [-]
};

/// Colours of light and of what lies on tissue, linear.
enum class Effect {
  kSmoke,            ///< smoke between lens and tissue
  kBlanched,         ///< tissue whose proteins have coagulated
  kScorched,         ///< tissue that has dried
  kCharred,          ///< tissue that has burnt
  kBloodFilm,        ///< tissue under a film of blood
  kBileFilm,         ///< tissue under a film of bile
  kPallor,           ///< tissue that is stretched until its blood has left it
  kThinRim,          ///< added at the rim of a thin wall
  kShade,            ///< what is left of the light in folds and in the shade of tools
  kBounce,           ///< light that tissue throws back on tissue
  kTissueHighlight,  ///< of the wet film
  kMetalHighlight,   ///< of tools
  kMirroredLens,     ///< what metal mirrors around the lens
  kMirroredTissue,   ///< what metal mirrors beside it
  kMirroredWall,     ///< what liquids mirror
  kMirroredBox,      ///< what metal mirrors in a box trainer
  kStrandShade,      ///< what is left of the light on the far side of strands and drops
  kCount
};
/// "smoke", "blanched", ...
std::string_view EffectName(Effect effect) noexcept;

struct Looks {
  std::array<MaterialLook, static_cast<std::size_t>(Material::kCount)> materials;
  math::Vec3 light_offset;          ///< of the light beside the lens, camera frame [m]
  double smoke = 0;                 ///< share of the light that is lost on the way where smoke is 1 [1/m]
  std::array<double, 3> pigment{};  ///< how strongly blood, bile and rinse colour a mixture [-]
  double trainer_light =
      1;  ///< power of the light in a box trainer, whose walls are darker than tissue and farther [-]
  double trainer_lid = 0;  ///< power of the lamp in its lid [-]
  /// Linear, 0 to 1.
  std::array<std::array<double, 3>, static_cast<std::size_t>(Effect::kCount)> effects{};

  const MaterialLook& operator[](Material material) const {
    return materials[static_cast<std::size_t>(material)];
  }
};

/// Where the looks lie in the data folder.
inline constexpr const char* kLooksFile = "assets/looks/laparoscope.json";

/// Reads looks (schemas/looks.schema.json); each material must be there.
/// \return the file's error: kFileMissing, kJsonSyntax or kJsonField with the place
base::Result<Looks> ReadLooks(const std::filesystem::path& path);

}  // namespace trocar::render
