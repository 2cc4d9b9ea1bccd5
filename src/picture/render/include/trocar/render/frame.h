// SPDX-License-Identifier: Apache-2.0
/// \file frame.h  Everything that one picture of the laparoscope shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "trocar/math/pose.h"
#include "trocar/math/vector.h"
#include "trocar/render/material.h"

namespace trocar::render {

/// A surface on the graphics card. The default one names none.
struct SurfaceId {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;

  friend bool operator==(const SurfaceId&, const SurfaceId&) = default;
};

/// The picture's diameter as a share of its height: the circle is cut a little at top and bottom, as on a
/// wide screen.
inline constexpr double kMaskDiameter = 1.14;

struct Camera {
  /// Origin at the lens, looking along -z, +y up in the picture.
  math::Pose X_world_camera;
  /// Across the round picture, its diameter [rad], 0.1 to 2.8; a telescope's data sheet calls it diagonal.
  double field_of_view = 1.308997;
};

/// One surface in one place. Deforming organs lie in the world frame and keep the identity.
struct SurfaceDraw {
  SurfaceId surface;
  math::Pose X_world_surface;
  std::uint16_t label = 0;  ///< in a GeometryPicture; 0 leaves it out of that
};

/// An arrow of light blue, for example a force at a tool's tip. Nothing hides it.
struct Arrow {
  math::Vec3 p_world_tail;  ///< [m]
  math::Vec3 span;          ///< from tail to head, world frame [m]
  double radius = 0.0012;   ///< of its shaft [m]
};

/// A straight piece that takes light from what is near it, for example the end of a tool.
struct Shade {
  math::Vec3 a, b;    ///< ends, world frame [m]
  double radius = 0;  ///< [m]
};
inline constexpr std::size_t kMaxShades = 10;

/// A ring that lies, for example on a peg: it takes light from what is under it where there is an overhead light.
struct RingShade {
  math::Vec3 centre;  ///< world frame [m]
  double radius = 0;  ///< of its circle [m]
};
inline constexpr std::size_t kMaxRingShades = 12;

/// A lamp in the lid of a box trainer: it throws shadows straight down.
struct OverheadLight {
  math::Vec3 up{0, 0, 1};  ///< direction to it, world frame, unit
  double power = 0;        ///< light on what faces it, 0 none [-]
};

/// Quality of a picture against its cost. The lowest leaves out what is expensive where the processor draws.
enum class Quality {
  kLow,  ///< no glow of highlights, no filtering of their edges, no grain in them
  kHigh
};

inline constexpr double kLeastResolution = 0.25;

/// A fine thread between two places, for example of connective tissue: it faces the lens, is a little wavy, and keeps
/// some width however far it is.
struct Fibre {
  math::Vec3 a, b;        ///< ends, world frame [m]
  double width = 0.0003;  ///< [m]
  double wave = 0;        ///< how far it leaves the straight line [m]
  Material material = Material::kFibre;
  std::uint32_t seed = 0;  ///< its own shape and shade
};

/// A small soft lump, for example a lobule of fat or a drop.
struct Blob {
  math::Vec3 centre;  ///< world frame [m]
  double radius = 0;  ///< [m]
  Material material = Material::kFat;
  std::uint32_t seed = 0;
};

/// A soft cloud without an edge, for example of steam.
struct Puff {
  math::Vec3 centre;   ///< world frame [m]
  double radius = 0;   ///< where nothing is left of it [m]
  double opacity = 0;  ///< in the middle, 0 to 1 [-]
  Material material = Material::kSteam;
};

/// Something that sticks to the lens: nothing behind it is in focus.
struct Blot {
  math::Vec2 centre;  ///< from the picture's middle, +x right, +y up, in heights of the picture
  double radius = 0;  ///< in heights of the picture
  double thick = 0;   ///< 0 nothing to 1 hardly any light passes as it came [-]

  friend bool operator==(const Blot&, const Blot&) = default;
};
inline constexpr std::size_t kMaxBlots = 6;

/// Liquid that lies in a hollow.
struct Puddle {
  /// Its surface in the world frame, coloured by what it holds; the ambient occlusion of its vertices is the share of its
  /// colour and opacity that it has there: 1 where it is deep, 0 at the shore. One that names none is not drawn.
  SurfaceId surface;
  math::Vec3 centre;                      ///< of its level, world frame [m]
  math::Vec3 up{0, 0, 1};                 ///< against gravity, unit
  double radius = 0;                      ///< [m]
  double blood = 1, bile = 0, rinse = 0;  ///< shares of what it holds, in any unit, >= 0
};

/// Everything that one picture shows.
struct Frame {
  Camera camera;
  double light_power = 1;  ///< head light beside the lens; 1 exposes tissue at 0.10 m well [-]
  double exposure = 1;     ///< of the camera; with automatic exposure it is on top of that [-]
  /// The camera finds its exposure by its last pictures and the frames' times.
  bool has_automatic_exposure = false;
  Quality quality = Quality::kHigh;
  /// Pixels that are drawn to those of the picture, along each side, kLeastResolution to 1: with fewer it is drawn faster and
  /// enlarged. Needs the pass that smooths edges.
  double resolution = 1;
  OverheadLight overhead;
  double ring_section = 0.002;         ///< radius of the rings' section [m]
  std::vector<RingShade> ring_shades;  ///< the first kMaxRingShades count
  /// Drawn in this order; nearest first is fastest.
  std::vector<SurfaceDraw> surfaces;
  std::vector<Fibre> fibres;  ///< drawn after everything else
  std::vector<Blob> blobs;
  std::vector<Puddle> puddles;
  std::vector<Puff> puffs;
  std::vector<Blot>
      blots;  ///< the first kMaxBlots count; they need the pass that smooths edges, which then is made
  double tool_wear = 1;  ///< scratches of tools, in those of the looks [-]
  std::vector<Arrow> arrows;
  std::vector<Shade> shades;  ///< the first kMaxShades count
  double smoke = 0;           ///< haze between lens and tissue, 0 none to 1 thick [-]
  double time = 0;            ///< of the scene [s]: smoke drifts with it
  bool has_mask = true;       ///< round picture, black outside
  bool has_smooth_edges = true;
  bool is_wireframe = false;  ///< edges only
  /// Where nothing is, sRGB [0, 1]; black does not count for the exposure.
  std::array<double, 3> clear_colour{};
};

}  // namespace trocar::render
