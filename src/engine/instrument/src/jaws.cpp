// SPDX-License-Identifier: Apache-2.0
#include "jaws.h"

#include <algorithm>
#include <cmath>

#include "loft.h"
#include "trocar/base/assert.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/elementary.h"

namespace trocar::instrument {
namespace {

constexpr double kMarylandBow = 0.0019;  // m, how far the curved jaws leave the line from hinge to tip
constexpr double kScissorsBow = 0.0009;  // m, sideways
constexpr double kClipLength = 0.009;    // m
constexpr double kClipWire = 0.00045;    // m, half of a clip's thickness

/// 0 at both ends, 1 in the middle.
double Bow(double along) {
  return 4.0 * along * (1.0 - along);
}

/// Rings with -y and +y in turn for the upper jaw are the lower jaw's.
double Side(int side, double y) {
  return side * y;
}

/// Fine teeth: how far the inner face lies back at a place along the jaw.
double Tooth(double z, double pitch, double depth) {
  const double phase = z / pitch - std::floor(z / pitch);
  return depth * std::abs(2.0 * phase - 1.0);
}

/// Fenestrated: a frame round a window, so that tissue is held without being crushed.
geometry::TriangleMesh MakeGrasperJaw(const Tool& tool, int side) {
  constexpr int kSamples = 96;
  const double length = tool.jaw_length, half = 0.5 * tool.jaw_width, thick = tool.jaw_thickness;
  std::vector<Ring> rings;
  for (int i = 0; i < kSamples; ++i) {
    const double angle = 2.0 * M_PI * i / kSamples, c = math::Cos(angle), s = math::Sin(angle);
    const auto square = [](double value, double power) {
      return std::copysign(math::Pow(std::abs(value), power), value);
    };
    // outline and window; z falls towards the tip
    const double z = 0.5 * length * (1.0 - square(c, 0.45)), across = square(s, 0.45);
    const double taper = 0.62 + 0.38 * std::min(1.0, z / (0.45 * length));
    const double outer = half * taper * across;
    const double window_z = length * (0.46 - 0.30 * square(c, 0.6)), inner = 0.42 * half * square(s, 0.6);
    const auto low = [&](double at) { return Tooth(at, 0.0009, 0.07 * thick); };
    const auto high = [&](double at) { return thick * (0.55 + 0.55 * std::min(1.0, at / (0.7 * length))); };
    const double cx = 0.12 * (inner - outer), cz = 0.12 * (window_z - z), cy = 0.15 * thick;
    rings.push_back({{outer - 0.0 * cx, Side(side, low(z) + cy), z},
                     {outer, Side(side, high(z) - cy), z},
                     {outer + cx, Side(side, high(z)), z + cz},
                     {inner - cx, Side(side, high(window_z)), window_z - cz},
                     {inner, Side(side, high(window_z) - cy), window_z},
                     {inner, Side(side, low(window_z) + cy), window_z},
                     {inner - cx, Side(side, low(window_z)), window_z - cz},
                     {outer + cx, Side(side, low(z)), z + cz}});
  }
  return MakeLoop(rings);
}

/// Maryland: both jaws taper and bend to +y, so that they reach behind a duct.
geometry::TriangleMesh MakeMarylandJaw(const Tool& tool, int side) {
  constexpr int kSteps = 48;
  std::vector<Ring> rings;
  for (int i = 0; i <= kSteps; ++i) {
    // denser at the round nose
    const double share = static_cast<double>(i) / kSteps, along = share * (0.25 + 0.75 * share);
    const double z = along * tool.jaw_length, nose = std::sqrt(std::min(1.0, 0.04 + along / 0.05));
    const double half = 0.5 * tool.jaw_width * nose * (0.36 + 0.64 * along);
    const double thick = tool.jaw_thickness * nose * (0.50 + 0.62 * along);
    const double middle = -kMarylandBow * Bow(along);
    const double inner = Tooth(z, 0.0008, 0.06 * thick), outer = thick;
    const double low = side > 0 ? middle + inner : middle - outer;
    const double high = side > 0 ? middle + outer : middle - inner;
    rings.push_back(MakeBlockRing(z, -half, half, low, high));
  }
  return MakeLoft(rings);
}

/// Curved blades that slide past each other: the upper one on the +x side, its edge a little below the middle.
geometry::TriangleMesh MakeScissorsBlade(const Tool& tool, int side) {
  constexpr int kSteps = 24;
  constexpr double kOverlap = 0.0001;  // m
  std::vector<Ring> rings;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps, along = share * (0.3 + 0.7 * share);
    const double nose = std::sqrt(std::min(1.0, 0.03 + along / 0.10));
    const double back = 0.62 * tool.jaw_width * nose * (0.42 + 0.58 * along);
    const double thick = tool.jaw_thickness * nose * (0.5 + 0.5 * along);
    const double middle = kScissorsBow * Bow(along), z = along * tool.jaw_length;
    Ring ring = {{0, -kOverlap, z},       {0.35 * thick, 0.10 * back, z}, {thick, 0.45 * back, z},
                 {thick, 0.85 * back, z}, {0.7 * thick, back, z},         {0.2 * thick, back, z},
                 {0, 0.8 * back, z}};
    for (math::Vec3& p : ring) p = {middle + side * p.x, side * p.y, p.z};
    rings.push_back(std::move(ring));
  }
  return MakeLoft(rings);
}

/// Clip applier: a stout jaw whose inner face lies back for the leg of the clip.
geometry::TriangleMesh MakeClipJaw(const Tool& tool, int side) {
  constexpr int kSteps = 20;
  std::vector<Ring> rings;
  for (int i = 0; i <= kSteps; ++i) {
    const double along = static_cast<double>(i) / kSteps;
    const double nose = std::sqrt(std::min(1.0, 0.06 + along / 0.12));
    const double half = 0.5 * tool.jaw_width * nose;
    const double thick = tool.jaw_thickness * nose * (0.9 + 0.7 * along);
    const double low = 0.6 * kClipWire, high = low + thick;
    rings.push_back(
        MakeBlockRing(along * tool.jaw_length, -half, half, side > 0 ? low : -high, side > 0 ? high : -low));
  }
  return MakeLoft(rings);
}

/// Linear stapler: a long bar, blunt at the tip; the lower one, which holds the cartridge, is the stouter.
geometry::TriangleMesh MakeStaplerJaw(const Tool& tool, int side) {
  constexpr int kSteps = 24;
  std::vector<Ring> rings;
  for (int i = 0; i <= kSteps; ++i) {
    const double along = static_cast<double>(i) / kSteps;
    const double nose = std::sqrt(std::min(1.0, 0.10 + along / 0.10));
    const double half = 0.5 * tool.jaw_width * nose;
    const double low = 0.0003, high = low + tool.jaw_thickness * nose * (side > 0 ? 0.8 : 1.15);
    rings.push_back(
        MakeBlockRing(along * tool.jaw_length, -half, half, side > 0 ? low : -high, side > 0 ? high : -low));
  }
  return MakeLoft(rings);
}

}  // namespace

geometry::TriangleMesh MakeJaw(const Tool& tool, int side) {
  TROCAR_ASSERT(tool.max_jaw > 0.0 && (side == 1 || side == -1));
  switch (tool.kind) {
    case ToolKind::kDissector:
      return MakeMarylandJaw(tool, side);
    case ToolKind::kScissors:
      return MakeScissorsBlade(tool, side);
    case ToolKind::kClipApplier:
      return MakeClipJaw(tool, side);
    case ToolKind::kLinearStapler:
      return MakeStaplerJaw(tool, side);
    default:
      return MakeGrasperJaw(tool, side);
  }
}

geometry::TriangleMesh MakeClipLeg(const Tool& tool, int side) {
  // from the tip to the root, which bends to the middle and meets the other leg there
  const double root = std::min(kClipLength, tool.jaw_length - 0.002), y = side * kClipWire;
  geometry::CentreLine leg;
  leg.points = {
      {0, y, 0.0001}, {0, y, 0.0006}, {0, y, 0.85 * root}, {0, 0.5 * y, root}, {0, -y, root + 0.0004}};
  leg.radii = {0.6 * kClipWire, kClipWire, kClipWire, kClipWire, 0.8 * kClipWire};
  return geometry::MakeTube(leg, 10);
}

}  // namespace trocar::instrument
