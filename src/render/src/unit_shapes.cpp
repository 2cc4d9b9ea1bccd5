// SPDX-License-Identifier: Apache-2.0
#include "unit_shapes.h"

#include <cmath>

#include "trocar/geometry/tube.h"

namespace trocar::render {
namespace {

constexpr int kPuddleSides = 40, kPuddleRings = 6;
constexpr double kPuddleDome = 0.035;  // rise of a puddle's middle, in its radius

}  // namespace

geometry::TriangleMesh MakeUnitRod() {
  return geometry::MakeTube({{{0, 0, 0}, {0, 0, 1}}, {1.0, 1.0}}, 16);
}

geometry::TriangleMesh MakeUnitCone() {
  return geometry::MakeTube({{{0, 0, 0}, {0, 0, 1}}, {1.0, 0.02}}, 16);
}

geometry::TriangleMesh MakeUnitPuddle() {
  geometry::TriangleMesh mesh;
  mesh.positions.push_back({0, 0, kPuddleDome});
  for (int ring = 1; ring <= kPuddleRings; ++ring) {
    // rings crowd at the shore, where the surface bends
    const double share = std::sqrt(static_cast<double>(ring) / kPuddleRings);
    for (int side = 0; side < kPuddleSides; ++side) {
      const double angle = 2.0 * M_PI * side / kPuddleSides;
      const double shore = 1.0 + 0.10 * std::sin(2 * angle + 0.7) + 0.07 * std::sin(3 * angle + 2.1) +
                           0.04 * std::sin(5 * angle);
      mesh.positions.push_back({share * shore * std::cos(angle), share * shore * std::sin(angle),
                                kPuddleDome * (1.0 - std::pow(share, 6))});
    }
  }
  const auto at = [](int ring, int side) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * kPuddleSides + side % kPuddleSides);
  };
  for (int side = 0; side < kPuddleSides; ++side) {
    mesh.triangles.push_back({0, at(1, side), at(1, side + 1)});
    for (int ring = 1; ring < kPuddleRings; ++ring) {
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side), at(ring + 1, side + 1)});
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring, side + 1)});
    }
  }
  return mesh;
}

std::vector<double> CalcPuddleOpacity() {
  std::vector<double> shares(1 + std::size_t{kPuddleSides} * kPuddleRings, 1.0);
  for (std::size_t side = 0; side < kPuddleSides; ++side) {
    shares[shares.size() - 1 - side] = 0.0;
    shares[shares.size() - 1 - side - kPuddleSides] = 0.85;
  }
  return shares;
}

}  // namespace trocar::render
