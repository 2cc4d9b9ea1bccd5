// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/organ_contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/collision/queries.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

/// What overlaps by more comes apart over several ticks [m].
constexpr double kMostPush = 0.002;
/// Most that a spring keeps pressed from tick to tick [m]: 3 N at the stiffness of the settings.
constexpr double kMostKept = 0.03;
/// Nearer to a surface than this, the way to it names no direction [m].
constexpr double kSamePoint = 1e-5;

/// Signed distance of a node to an organ's surface, with the nearest point.
struct Place {
  bool is_near = false;
  collision::NearestTriangle nearest;
  Vec3 outwards;  // unit, from or through the nearest point
  double distance = 0;
};

/// \param[in,out] is_inside  what the node was before; looked at again where the surface beside it says otherwise
Place FindPlace(const OrganSurface& organ, std::span<const Vec3> nodes, const Vec3& p, double reach,
                std::uint32_t guess, std::uint8_t& is_inside) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < organ.box.min[axis] - reach || p[axis] > organ.box.max[axis] + reach) return {};
  }
  Place place;
  // a guess that is far by now would widen the search: it counts only within reach
  place.nearest = organ.tree.FindNearest(nodes, p, {.max_distance = reach, .first_guess = guess});
  if (!place.nearest.Found()) return place;
  const auto side = collision::FindSide(nodes, organ.triangles, organ.vertex_triangles, p, place.nearest);
  if ((side.distance < 0.0) != (is_inside != 0)) is_inside = organ.tree.IsInside(nodes, p) ? 1 : 0;
  const double distance = std::sqrt(place.nearest.squared_distance);
  place.distance = is_inside != 0 ? -distance : distance;
  const Vec3 away = (p - place.nearest.point) / distance;
  place.outwards = !(distance > kSamePoint) ? side.normal : is_inside != 0 ? -away : away;
  place.is_near = math::SquaredNorm(place.outwards) > 0.0;
  return place;
}

void Resize(OrganPair& pair) {
  pair.allowed.resize(pair.node_count, 0.0);
  pair.is_inside.resize(pair.node_count, 0);
  pair.warm_start.resize(pair.node_count, 0.0);
  pair.is_bound.resize(pair.node_count, 0);
  pair.last_triangle.resize(pair.node_count, collision::kNoTriangle);
  pair.spring.resize(pair.node_count, kNoSpring);
  pair.clear.assign(pair.node_count, {});
}

/// Whether a vertex that was clear when it was last looked at must still be: nothing has gone so far since.
bool IsStillClear(const ClearVertex& clear, const Vec3& p, double travel) noexcept {
  const double left = clear.until - travel;
  return left > 0.0 && math::SquaredDistance(p, clear.position) < left * left;
}

/// Fills in what is allowed at rest.
OrganPair MakePair(const OrganSurface& to, std::span<const Vec3> positions, OrganPair pair,
                   const OrganContactSettings& settings) {
  const auto nodes = to.Nodes(positions);
  Resize(pair);
  for (std::uint32_t i = 0; i < pair.node_count; ++i) {
    const Vec3& p = positions[pair.first_node + i];
    const double radius = pair.radii.empty() ? 0.0 : pair.radii[i];
    pair.is_inside[i] = to.tree.IsInside(nodes, p) ? 1 : 0;
    const Place place =
        FindPlace(to, nodes, p, settings.reach + radius, collision::kNoTriangle, pair.is_inside[i]);
    // a tube has its radius
    const double wanted = pair.radii.empty() ? settings.thickness : 0.0;
    pair.allowed[i] = place.nearest.Found() ? std::min(wanted, place.distance - radius) : wanted;
    pair.last_triangle[i] = place.nearest.triangle;
  }
  pair.allowed_at_rest = pair.allowed;
  pair.inside_at_rest = pair.is_inside;
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

void UpdateTopology(std::span<const OrganSurface> organs, std::uint8_t changed, OrganPair& pair) {
  if (changed == pair.nodes_of) {
    pair.node_count = organs[changed].node_count;
    Resize(pair);
  }
  if (changed == pair.surface_of) {
    std::fill(pair.last_triangle.begin(), pair.last_triangle.end(), collision::kNoTriangle);
    std::fill(pair.clear.begin(), pair.clear.end(), ClearVertex{});
  }
}

void ResetPair(OrganPair& pair) noexcept {
  const std::size_t count = std::min(pair.allowed.size(), pair.allowed_at_rest.size());
  std::copy_n(pair.allowed_at_rest.begin(), count, pair.allowed.begin());
  std::copy_n(pair.inside_at_rest.begin(), count, pair.is_inside.begin());
  std::fill(pair.clear.begin(), pair.clear.end(), ClearVertex{});
  ForgetWarmStartForces(pair);
}

void ForgetWarmStartForces(OrganPair& pair) noexcept {
  std::fill(pair.warm_start.begin(), pair.warm_start.end(), 0.0);
  std::fill(pair.spring.begin(), pair.spring.end(), kNoSpring);
}

void KeepWarmStartForces(std::span<const Vec3> positions, const ContactSet& contacts,
                         OrganPair& pair) noexcept {
  for (std::uint32_t i = 0; i < pair.node_count; ++i) {
    const std::uint32_t at = pair.spring[i];
    pair.warm_start[i] = 0.0;
    if (at == kNoSpring) continue;
    double depth = 0;
    for (const std::uint32_t k : {at, at + 1})
      depth += 0.5 * std::max(0.0, tissue::CalcContactDepth(contacts.springs[k], positions));
    pair.warm_start[i] = std::min(depth, kMostKept);
  }
}

void FindOrganContacts(std::span<const OrganSurface> organs, std::span<const Vec3> positions,
                       const OrganContactSettings& settings, OrganPair& pair, ContactSet& contacts) noexcept {
  const OrganSurface& to = organs[pair.surface_of];
  const auto nodes = to.Nodes(positions);
  for (std::uint32_t i = 0; i < pair.node_count; ++i) {
    pair.spring[i] = kNoSpring;
    if (pair.is_bound[i] != 0) continue;
    const std::uint32_t node = pair.first_node + i;
    const Vec3& p = positions[node];
    if (IsStillClear(pair.clear[i], p, to.travel)) continue;
    const double radius = pair.radii.empty() ? 0.0 : pair.radii[i];
    const Place place =
        FindPlace(to, nodes, p, settings.reach + radius, pair.last_triangle[i], pair.is_inside[i]);
    const double gap = place.is_near ? place.distance - radius : place.nearest.Found() ? 0.0 : settings.reach;
    if (place.is_near && pair.radii.empty())
      pair.allowed[i] = std::max(pair.allowed[i], std::min(gap, settings.thickness));
    const double spare = pair.is_inside[i] != 0 ? 0.0 : gap - pair.allowed[i] - settings.ahead;
    pair.clear[i] = {p, spare > 0.0 ? to.travel + spare : 0.0};
    if (!place.is_near) continue;
    pair.last_triangle[i] = place.nearest.triangle;
    const double clearance = std::max(gap - pair.allowed[i], -kMostPush);
    if (clearance > settings.ahead) continue;
    if (contacts.springs.size() + 2 > ContactSet::kCapacity) {
      ++contacts.dropped;
      continue;
    }
    const Vec3& n = place.outwards;
    ContactLink link;
    link.hand = kNoHand;
    link.key = ~std::uint64_t{0};
    link.surface = pair.nodes_of;
    // each gives way by half of what is missing, against what presses it already
    const double ahead = pair.warm_start[i] - 0.5 * clearance;
    const auto& t = to.triangles[place.nearest.triangle];
    pair.spring[i] = static_cast<std::uint32_t>(contacts.springs.size());
    contacts.springs.push_back({{node, to.first_node + t[0], to.first_node + t[1]},
                                {1.0, 0.0, 0.0},
                                n,
                                math::Dot(n, p) + ahead,
                                settings.stiffness});
    contacts.links.push_back(link);
    link.surface = pair.surface_of;
    contacts.springs.push_back({{to.first_node + t[0], to.first_node + t[1], to.first_node + t[2]},
                                place.nearest.weights,
                                -n,
                                -math::Dot(n, place.nearest.point) + ahead,
                                settings.stiffness});
    contacts.links.push_back(link);
  }
}

void VisitState(base::StateArchive& archive, OrganPair& pair) {
  archive.FixedField("allowed", pair.allowed);
  archive.FixedField("is_inside", pair.is_inside);
  archive.FixedField("warm_start", pair.warm_start);
  archive.FixedField("last_triangle", pair.last_triangle);
  archive.FixedField("clear", pair.clear);
}

}  // namespace trocar::surgery
