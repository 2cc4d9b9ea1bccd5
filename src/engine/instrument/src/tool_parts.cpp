// SPDX-License-Identifier: Apache-2.0
// What stays with the shaft: tubes, hubs, the electrode, the suction tube, the bag.
#include <algorithm>
#include <array>
#include <cmath>

#include "jaws.h"
#include "loft.h"
#include "trocar/geometry/tube.h"
#include "trocar/instrument/tool.h"
#include "trocar/math/elementary.h"

namespace trocar::instrument {

using math::Vec3;

namespace {

using geometry::TriangleMesh;
using math::Cos;
using math::Pow;
using math::Sin;
using Kind = ToolPart::Kind;

constexpr int kSides = 24;
constexpr double kHubLength = 0.008;        // m of bare metal between hinge and insulation
constexpr double kToeLength = 0.0045;       // m, of the hook: domain facts, section 1.3
constexpr double kToeBend = 0.0009;         // m, radius of the hook's bend
constexpr double kBoreDepth = 0.024;        // m
constexpr double kBagWire = 0.0007;         // m, half of the spring ring's thickness
constexpr double kPouchThickness = 0.0002;  // m

/// Tube of the shaft from `start`, its edge broken.
TriangleMesh MakeShaft(const Tool& tool, double start) {
  const double r = tool.shaft_radius;
  return geometry::MakeTube(
      {{{0, 0, start}, {0, 0, start + 0.0002}, {0, 0, start + 0.0012}, {0, 0, tool.shaft_length}},
       {0.80 * r, 0.93 * r, r, r}},
      kSides);
}

/// Hub of the hinge: round at the shaft, flat between the jaws, with the head of the pin on both sides.
TriangleMesh MakeHub(const Tool& tool) {
  const double r = tool.shaft_radius, hinge = tool.jaw_length;
  const double flat = std::min(0.9 * r, 0.75 * tool.jaw_width),
               high = std::min(0.55 * r, 1.3 * tool.jaw_thickness);
  std::vector<Ring> rings;
  for (const double share : {0.0, 0.12, 0.3, 0.5, 0.7, 0.85, 1.0, 1.2}) {
    const double round = std::clamp((share - 0.3) / 0.55, 0.0, 1.0), mix = round * round * (3 - 2 * round);
    const double nose = share == 0.0 ? 0.75 : 1.0;
    rings.push_back(MakeRoundRing(hinge - 0.0015 + share * kHubLength,
                                  nose * (flat + (0.94 * r - flat) * mix),
                                  nose * (high + (0.94 * r - high) * mix), 0.6 * (1 - mix), kSides));
  }
  TriangleMesh hub = MakeLoft(rings);
  const double pin = flat + 0.0003;
  Append(hub, geometry::MakeTube({{{-pin, 0, hinge}, {pin, 0, hinge}}, {0.0007, 0.0007}}, 12));
  return hub;
}

/// L-hook: a rod whose toe points along +y.
TriangleMesh MakeHook(const Tool& tool) {
  const double r = 0.5 * tool.jaw_width;
  geometry::CentreLine rod;
  const auto add = [&rod](double y, double z, double radius) {
    rod.points.push_back({0, y, z});
    rod.radii.push_back(radius);
  };
  add(0, tool.jaw_length + 0.002, r);
  add(0, 0.5 * (tool.jaw_length + kToeBend), r);
  for (int i = 0; i <= 8; ++i) {
    const double angle = 0.5 * M_PI * i / 8;
    add(kToeBend * (1 - Cos(angle)), kToeBend * (1 - Sin(angle)), r);
  }
  add(kToeLength - 0.8 * r, 0, 0.95 * r);
  add(kToeLength - 0.25 * r, 0, 0.75 * r);
  add(kToeLength, 0, 0.35 * r);
  return geometry::MakeTube(rod, 16);
}

/// Insulated end of the electrode's shaft: it narrows to a collar from which the bare metal comes.
TriangleMesh MakeElectrodeShaft(const Tool& tool) {
  const double r = tool.shaft_radius, start = tool.jaw_length;
  return geometry::MakeTube({{{0, 0, start},
                              {0, 0, start + 0.0003},
                              {0, 0, start + 0.0030},
                              {0, 0, start + 0.0036},
                              {0, 0, tool.shaft_length}},
                             {0.50 * r, 0.58 * r, 0.66 * r, r, r}},
                            kSides);
}

/// Suction tube: an open end and two rows of side holes into the bore, so that it does not suck itself fast.
TriangleMesh MakeSuctionTube(const Tool& tool) {
  constexpr std::uint32_t kRings = 22;
  constexpr double kStep = 0.0006;  // m between rings near the tip
  constexpr std::uint32_t kHoleRings[] = {4, 9, 14};
  const double outer = tool.shaft_radius, inner = kSuctionBore * outer;
  TriangleMesh mesh;
  // (ring, side) of the outer wall, then of the inner; the last outer ring lies at the far end of the tube
  const auto place = [](bool is_inner, std::uint32_t ring, std::uint32_t side) {
    return (is_inner ? kRings * kSides : 0u) + ring * kSides + side % kSides;
  };
  // whether the place is the corner of a hole two cells wide, which is drawn in, or its middle, which goes
  const auto find_hole = [&](std::uint32_t ring, std::uint32_t side) {
    for (const std::uint32_t first : kHoleRings) {
      const std::uint32_t offset = first == 9 ? 3 : 0;
      if (ring < first || ring > first + 2) continue;
      for (std::uint32_t start = offset; start < kSides; start += 6) {
        const std::uint32_t across = (side + kSides - start) % kSides;
        if (across <= 2)
          return std::array<int, 2>{static_cast<int>(ring - first) - 1, static_cast<int>(across) - 1};
      }
    }
    return std::array<int, 2>{9, 9};
  };
  for (const bool is_inner : {false, true}) {
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
      for (std::uint32_t side = 0; side < kSides; ++side) {
        const auto [up, across] = find_hole(ring, side);
        const bool is_corner = std::abs(up) == 1 && std::abs(across) == 1;
        const double angle = 2 * M_PI * (side - (is_corner ? 0.28 * across : 0.0)) / kSides;
        const double radius = is_inner ? inner : (ring == 0 ? 0.94 * outer : outer);
        double z = kStep * (ring - (is_corner ? 0.28 * up : 0.0));
        if (ring + 1 == kRings) z = is_inner ? kBoreDepth : tool.shaft_length;
        mesh.positions.push_back({radius * Cos(angle), radius * Sin(angle), z});
      }
    }
  }
  const auto add_quad = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  const auto is_hole_cell = [&](std::uint32_t ring, std::uint32_t side) {
    const auto low = find_hole(ring, side), high = find_hole(ring + 1, side + 1);
    return low[0] < 1 && low[1] < 1 && high[0] - low[0] == 1 && high[1] - low[1] == 1;
  };
  for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t next = side + 1;
      if (!is_hole_cell(ring, side)) {
        add_quad(place(false, ring, side), place(false, ring, next), place(false, ring + 1, next),
                 place(false, ring + 1, side));
        add_quad(place(true, ring, side), place(true, ring + 1, side), place(true, ring + 1, next),
                 place(true, ring, next));
        continue;
      }
      // walls of the hole where the neighbouring cell is none
      const auto wall = [&](std::uint32_t r0, std::uint32_t s0, std::uint32_t r1, std::uint32_t s1) {
        add_quad(place(false, r0, s0), place(false, r1, s1), place(true, r1, s1), place(true, r0, s0));
      };
      if (!is_hole_cell(ring - 1, side)) wall(ring, side, ring, next);
      if (!is_hole_cell(ring + 1, side)) wall(ring + 1, next, ring + 1, side);
      if (!is_hole_cell(ring, (side + kSides - 1) % kSides)) wall(ring + 1, side, ring, side);
      if (!is_hole_cell(ring, next)) wall(ring, next, ring + 1, next);
    }
  }
  // the open end, the bottom of the bore and the far end
  const auto bottom = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({0, 0, kBoreDepth});
  mesh.positions.push_back({0, 0, tool.shaft_length});
  for (std::uint32_t side = 0; side < kSides; ++side) {
    add_quad(place(false, 0, side + 1), place(false, 0, side), place(true, 0, side),
             place(true, 0, side + 1));
    mesh.triangles.push_back({bottom, place(true, kRings - 1, side + 1), place(true, kRings - 1, side)});
    mesh.triangles.push_back(
        {bottom + 1, place(false, kRings - 1, side), place(false, kRings - 1, side + 1)});
  }
  // middles of the holes belong to nothing
  std::vector<std::uint32_t> kept(mesh.positions.size(), 0);
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) kept[v] = 1;
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < kept.size(); ++v) {
    if (kept[v] == 0) continue;
    mesh.positions[count] = mesh.positions[v];
    kept[v] = count++;
  }
  mesh.positions.resize(count);
  for (geometry::Triangle& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) v = kept[v];
  return mesh;
}

/// Neck of the bag's tube and the spring ring that holds its mouth open.
TriangleMesh MakeBagRing(const Tool& tool) {
  constexpr int kAround = 72, kWireSides = 8;
  const double radius = 0.5 * kBagMouth - kBagWire;
  std::vector<Ring> rings;
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * M_PI * i / kAround;
    const Vec3 out{Sin(angle), 0, Cos(angle)}, centre = Vec3{0, 0, -0.5 * kBagMouth} + radius * out;
    Ring ring;
    for (int side = 0; side < kWireSides; ++side) {
      const double turn = 2 * M_PI * side / kWireSides;
      ring.push_back(centre + kBagWire * (Cos(turn) * out + Vec3{0, Sin(turn), 0}));
    }
    rings.push_back(std::move(ring));
  }
  TriangleMesh mesh = MakeLoop(rings);
  Append(mesh, geometry::MakeTube({{{0, 0, -0.001}, {0, 0, 0.001}, {0, 0, tool.jaw_length + 0.002}},
                                   {0.0014, 0.0022, 0.0022}},
                                  kSides));
  return mesh;
}

/// Thin wall of the pouch, creased, deepest in its middle: outside from the bottom to the mouth, inside back.
TriangleMesh MakePouch() {
  constexpr int kAround = 64, kDown = 18;
  std::vector<Ring> rings;
  for (int step = 0; step <= 2 * kDown + 1; ++step) {
    const bool is_inside = step > kDown;
    const double down = static_cast<double>(is_inside ? step - kDown - 1 : kDown - step) / kDown;
    const double wall = is_inside ? kPouchThickness : 0.0;
    const double profile = std::sqrt(std::max(0.0, 1.0 - Pow(down, 2.6))) * (1.0 - 0.06 * down) + 0.012;
    Ring ring;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * M_PI * i / kAround;
      // folds hang down from the ring, and cross folds where the film is crumpled
      const double folded = std::sqrt(down);
      const double crease =
          1.0 + folded * (0.085 * Cos(5 * angle + 4 * down) + 0.050 * Cos(9 * angle - 7 * down) +
                          0.025 * Cos(17 * angle + 11 * down));
      const double radius = (0.5 * kBagMouth - kBagWire) * profile * crease - wall * profile;
      ring.push_back({radius * Sin(angle), -kBagDepth * down + (is_inside ? wall * down : 0.0),
                      -0.5 * kBagMouth + radius * Cos(angle)});
    }
    rings.push_back(std::move(ring));
  }
  return MakeLoft(rings);
}

}  // namespace

std::vector<ToolPart> MakeParts(const Tool& tool) {
  std::vector<ToolPart> parts;
  switch (tool.kind) {
    case ToolKind::kHook:
      return {{Kind::kShaft, MakeElectrodeShaft(tool)}, {Kind::kTip, MakeHook(tool)}};
    case ToolKind::kSuctionIrrigator: {
      const double r = 0.97 * kSuctionBore * tool.shaft_radius;
      return {
          {Kind::kShaft, MakeSuctionTube(tool)},
          {Kind::kBore, geometry::MakeTube({{{0, 0, 0.0008}, {0, 0, kBoreDepth - 0.001}}, {r, r}}, kSides)}};
    }
    case ToolKind::kBag:
      return {{Kind::kShaft, MakeShaft(tool, tool.jaw_length)},
              {Kind::kTip, MakeBagRing(tool)},
              {Kind::kPouch, MakePouch()}};
    default:
      break;
  }
  parts.push_back({Kind::kShaft, MakeShaft(tool, tool.jaw_length - 0.0015 + kHubLength)});
  parts.push_back({Kind::kTip, MakeHub(tool)});
  parts.push_back({Kind::kUpperJaw, MakeJaw(tool, +1)});
  parts.push_back({Kind::kLowerJaw, MakeJaw(tool, -1)});
  if (AbilitiesOf(tool.kind).holds_clips) {
    parts.push_back({Kind::kUpperClip, MakeClipLeg(tool, +1)});
    parts.push_back({Kind::kLowerClip, MakeClipLeg(tool, -1)});
  }
  return parts;
}

}  // namespace trocar::instrument
