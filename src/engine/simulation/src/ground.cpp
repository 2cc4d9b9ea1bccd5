// SPDX-License-Identifier: Apache-2.0
#include "trocar/simulation/ground.h"

namespace trocar::simulation {
namespace {

constexpr double kGap = 0.002;       // between what lies above and the omentum [m]
constexpr std::uint32_t kEvery = 3;  // vertex of an organ: they lie close

}  // namespace

std::vector<geometry::Ball> FindOmentumBalls(std::span<const scene::SurfaceInfo> surfaces,
                                             std::span<const math::Vec3> positions) {
  std::vector<geometry::Ball> balls;
  for (const scene::SurfaceInfo& surface : surfaces) {
    if (surface.organ == roles::OrganRole::kLiver) continue;  // the omentum rests on it
    const bool is_tube = surface.triangles.empty();
    for (std::uint32_t i = 0; i < surface.node_count; i += is_tube ? 1 : kEvery) {
      const double radius = is_tube ? surface.radii[i] : 0.0;
      balls.push_back({positions[surface.first_node + i], radius + kGap});
    }
  }
  return balls;
}

}  // namespace trocar::simulation
