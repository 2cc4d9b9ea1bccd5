// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/organ_contact.h"

#include <algorithm>
#include <utility>

#include "trocar/collision/queries.h"

namespace trocar::surgery {
namespace {

/// What overlaps by more comes apart over several ticks [m].
constexpr double kMostPush = 0.002;

/// Signed distance of a node to an organ's surface, with the nearest point.
struct Place {
  bool is_near = false;
  collision::NearestTriangle nearest;
  collision::SurfaceSide side;
};

Place FindPlace(const OrganSurface& organ, std::span<const Vec3> nodes, const Vec3& p, double reach,
                std::uint32_t guess) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < organ.box.min[axis] - reach || p[axis] > organ.box.max[axis] + reach) return {};
  }
  Place place;
  // a guess that is far by now would widen the search: it counts only within reach
  place.nearest = organ.tree.FindNearest(nodes, p, {.max_distance = reach, .first_guess = guess});
  if (!place.nearest.Found()) return place;
  place.side = collision::FindSide(nodes, organ.triangles, organ.vertex_triangles, p, place.nearest);
  place.is_near = math::SquaredNorm(place.side.normal) > 0.0;
  return place;
}

/// Fills in what is allowed at rest.
OrganPair MakePair(const OrganSurface& to, std::span<const Vec3> positions, OrganPair pair,
                   const OrganContactSettings& settings) {
  pair.allowed.assign(pair.node_count, 0.0);
  pair.is_bound.assign(pair.node_count, 0);
  pair.last_triangle.assign(pair.node_count, collision::kNoTriangle);
  for (std::uint32_t i = 0; i < pair.node_count; ++i) {
    const double radius = pair.radii.empty() ? 0.0 : pair.radii[i];
    const Place place = FindPlace(to, to.Nodes(positions), positions[pair.first_node + i],
                                  settings.reach + radius, collision::kNoTriangle);
    if (!place.nearest.Found()) continue;
    pair.last_triangle[i] = place.nearest.triangle;
    pair.allowed[i] = std::min(0.0, place.side.distance - radius);
  }
  return pair;
}

}  // namespace

OrganPair MakeOrganPair(std::span<const OrganSurface> organs, std::span<const Vec3> positions,
                        std::uint8_t vertices_of, std::uint8_t surface_of,
                        std::span<const std::uint32_t> bound, const OrganContactSettings& settings) {
  const OrganSurface& from = organs[vertices_of];
  OrganPair pair;
  pair.nodes_of = vertices_of, pair.surface_of = surface_of;
  pair.first_node = from.first_node, pair.node_count = from.node_count;
  pair = MakePair(organs[surface_of], positions, std::move(pair), settings);
  for (const std::uint32_t node : bound) {
    if (node >= from.first_node && node < from.first_node + from.node_count)
      pair.is_bound[node - from.first_node] = 1;
  }
  return pair;
}

OrganPair MakeTubePair(std::span<const OrganSurface> organs, std::span<const Vec3> positions,
                       const TubeSurface& tube, std::uint8_t surface, std::uint8_t surface_of,
                       const OrganContactSettings& settings) {
  OrganPair pair;
  pair.nodes_of = surface, pair.surface_of = surface_of;
  pair.first_node = tube.first_node, pair.node_count = tube.node_count;
  pair.radii = tube.radii;
  return MakePair(organs[surface_of], positions, std::move(pair), settings);
}

void FollowOrgan(std::span<const OrganSurface> organs, std::uint8_t changed, OrganPair& pair) {
  if (changed == pair.nodes_of) {
    const std::uint32_t count = organs[changed].node_count;
    pair.node_count = count;
    pair.allowed.resize(count, 0.0);
    pair.is_bound.resize(count, 0);
    pair.last_triangle.resize(count, collision::kNoTriangle);
  }
  if (changed == pair.surface_of)
    std::fill(pair.last_triangle.begin(), pair.last_triangle.end(), collision::kNoTriangle);
}

void FindOrganContacts(std::span<const OrganSurface> organs, std::span<const Vec3> positions,
                       const OrganContactSettings& settings, OrganPair& pair, ContactSet& contacts) noexcept {
  const OrganSurface& to = organs[pair.surface_of];
  const auto nodes = to.Nodes(positions);
  for (std::uint32_t i = 0; i < pair.node_count; ++i) {
    if (pair.is_bound[i] != 0) continue;
    const std::uint32_t node = pair.first_node + i;
    const Vec3& p = positions[node];
    const double radius = pair.radii.empty() ? 0.0 : pair.radii[i];
    const Place place = FindPlace(to, nodes, p, settings.reach + radius, pair.last_triangle[i]);
    if (!place.is_near) continue;
    pair.last_triangle[i] = place.nearest.triangle;
    const double room = std::max(place.side.distance - radius - pair.allowed[i], -kMostPush);
    if (room > settings.ahead) continue;
    if (contacts.springs.size() + 2 > ContactSet::kCapacity) {
      ++contacts.dropped;
      continue;
    }
    const Vec3& n = place.side.normal;
    ContactLink link;
    link.hand = kNoHand;
    link.key = ~std::uint64_t{0};
    link.surface = pair.nodes_of;
    // each gives way by half of what is missing
    const auto& t = to.triangles[place.nearest.triangle];
    contacts.springs.push_back({{node, to.first_node + t[0], to.first_node + t[1]},
                                {1.0, 0.0, 0.0},
                                n,
                                math::Dot(n, p) - 0.5 * room,
                                settings.stiffness});
    contacts.links.push_back(link);
    link.surface = pair.surface_of;
    contacts.springs.push_back({{to.first_node + t[0], to.first_node + t[1], to.first_node + t[2]},
                                place.nearest.weights,
                                -n,
                                -math::Dot(n, place.nearest.point) - 0.5 * room,
                                settings.stiffness});
    contacts.links.push_back(link);
  }
}

}  // namespace trocar::surgery
