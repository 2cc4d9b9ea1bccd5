// SPDX-License-Identifier: Apache-2.0
#include "trocar/geometry/openings.h"

namespace trocar::geometry {

using math::Vec3;

namespace {

/// The rim that starts at half-edge h; nothing where h is not its lowest.
Opening MeasureRim(const EditableMesh& mesh, std::uint32_t h) {
  Opening opening;
  Vec3 area;
  const Vec3 origin = mesh.Positions()[mesh.From(h)];
  std::uint32_t side = h;
  do {
    if (side < h) return {};
    const Vec3 &a = mesh.Positions()[mesh.From(side)], &b = mesh.Positions()[mesh.To(side)];
    area += 0.5 * math::Cross(a - origin, b - origin);
    opening.length += math::Distance(a, b);
    ++opening.edges;
    side = NextOnRim(mesh, side);
  } while (side != h);
  opening.half_edge = h;
  opening.area = math::Norm(area);
  return opening;
}

}  // namespace

std::size_t FindOpenings(const EditableMesh& mesh, std::span<Opening> openings) noexcept {
  std::size_t count = 0;
  for (std::uint32_t h = 0; h < 3 * mesh.TriangleCount(); ++h) {
    if (mesh.Twin(h) != kNone) continue;
    const Opening opening = MeasureRim(mesh, h);
    if (opening.half_edge == kNone) continue;
    if (count < openings.size()) openings[count] = opening;
    ++count;
  }
  return count;
}

std::vector<Triangle> MakeLids(const EditableMesh& mesh) {
  std::vector<Opening> openings(FindOpenings(mesh, {}));
  FindOpenings(mesh, openings);
  std::vector<Triangle> lids;
  for (const Opening& opening : openings) {
    const std::uint32_t first = mesh.From(opening.half_edge);
    std::uint32_t side = NextOnRim(mesh, opening.half_edge);
    for (std::size_t i = 2; i < opening.edges; ++i) {
      lids.push_back({first, mesh.To(side), mesh.From(side)});  // against the surface's own direction
      side = NextOnRim(mesh, side);
    }
  }
  return lids;
}

}  // namespace trocar::geometry
