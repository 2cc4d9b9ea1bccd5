// SPDX-License-Identifier: Apache-2.0
/// \file material_look.h  Parameters of the two shaders, one row a material.
#pragma once

#include <array>

#include "trocar/render/material.h"

namespace trocar::render {

using Colour = std::array<float, 3>;

/// Colours are linear (not sRGB) reflectances in [0, 1].
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
  float opacity = 1;          ///< below 1: light passes through, seen square on [-]
  float emission = 0;         ///< light of its own [-]
};

const MaterialLook& GetLook(Material material) noexcept;

}  // namespace trocar::render
