// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/contact.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/collision/queries.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

using collision::Capsule;
using collision::MovingSegment;
using collision::Segment;

/// Triangles or pieces that one body of a tool can touch in a tick.
constexpr std::size_t kMostCandidates = 512;
/// Springs of one body of a tool against one organ. Where more triangles are in its way, as in a crumpled sac, those that it
/// touches first stop it: the rest would use up the capacity that organs need against each other.
constexpr std::size_t kMostByBody = 64;
/// Tissue that snaps back farther than this in one solve is followed only so far [m].
constexpr double kMostMotion = 0.03;
/// Tissue that lies in the tool by more than it did, and by more than this, comes out over several ticks: pushed at once it
/// would throw about what is around it [m].
constexpr double kMostPush = 0.003;
/// Nearer than this, two points name no direction [m].
constexpr double kSamePoint = 1e-9;

/// A body's way, and what is looked for on it.
struct Search {
  const ToolMotion& motion;
  const ContactCandidates& candidates;
  const ContactSettings& settings;
  const ContactSet& last;
  ToolBody body;
  MovingSegment way;         // from the proxy to the device
  MovingSegment way_before;  // of the proxy during the last solve
  double radius;
  double most_push;        // of one spring [m]
  bool is_outside = true;  // of the organ that is looked at, as the proxy lies
};

/// How deep the deepest of a hand's springs was in the last tick [m].
double FindLastDepth(const ContactSet& last, std::uint8_t hand, double stiffness) noexcept {
  double largest = 0;
  for (const ContactLink& link : last.links) {
    if (link.hand == hand) largest = std::max(largest, link.normal_force);
  }
  return largest / stiffness;
}

/// Where a body touches a surface: point of the tissue by its nodes, and the direction away from the tool.
struct ContactPoint {
  std::array<std::uint32_t, 3> nodes;
  std::array<double, 3> weights;
  double parameter;  // on the body's axis
  Vec3 normal;       // unit
  double reach;      // sum of the radii [m]
  double rank = 0;   // low for what is touched early, beyond 1 what is only near at the end
  double time = -1;  // on the body's way, 0 to 1; negative: it was touched in the last solve
};

Vec3 PointOf(const ContactPoint& contact, std::span<const Vec3> positions) noexcept {
  Vec3 point;
  for (int i = 0; i < 3; ++i) point += contact.weights[i] * positions[contact.nodes[i]];
  return point;
}

Vec3 PointOf(const tissue::ContactSpring& spring, std::span<const Vec3> positions) noexcept {
  Vec3 point;
  for (int i = 0; i < 3; ++i) point += spring.weights[i] * positions[spring.nodes[i]];
  return point;
}

std::uint64_t MakeKey(const Search& search, std::size_t surface, std::uint32_t item) noexcept {
  return (static_cast<std::uint64_t>(search.motion.hand) << 56) |
         (static_cast<std::uint64_t>(search.body) << 48) | (static_cast<std::uint64_t>(surface) << 32) | item;
}

/// The same contact in the tick before; keys ascend.
std::ptrdiff_t FindLast(const ContactSet& last, std::uint64_t key) noexcept {
  const auto at = std::lower_bound(last.links.begin(), last.links.end(), key,
                                   [](const ContactLink& link, std::uint64_t k) { return link.key < k; });
  return at != last.links.end() && at->key == key ? at - last.links.begin() : -1;
}

void AddSpring(const tissue::ContactSpring& spring, const ContactLink& link, ContactSet& contacts) noexcept {
  if (contacts.springs.size() == ContactSet::kCapacity) {
    ++contacts.dropped;
    return;
  }
  contacts.springs.push_back(spring);
  contacts.links.push_back(link);
}

/// How far the tool has carried its sticking point along the surface, within Coulomb's limit [m].
Vec3 FindStretch(const Search& search, std::uint64_t key, const Vec3& normal) noexcept {
  const std::ptrdiff_t at = FindLast(search.last, key);
  if (at < 0) return {};
  const ContactLink& before = search.last.links[static_cast<std::size_t>(at)];
  const Vec3 tissue = PointOf(search.last.springs[static_cast<std::size_t>(at)], search.candidates.positions);
  const Vec3 carried = search.motion.X_world_device * before.p_tool_stuck - tissue;
  const Vec3 along = carried - math::Dot(carried, normal) * normal;
  const double most = search.settings.friction * before.normal_force / search.settings.stiffness;
  const double length = math::Norm(along);
  return length > most ? (most / length) * along : along;
}

void AddContact(const Search& search, const ContactPoint& contact, std::size_t surface, std::uint32_t item,
                ContactSet& contacts) noexcept {
  const Vec3 p_device = math::Lerp(search.way.to.start, search.way.to.end, contact.parameter);
  const std::uint64_t key = MakeKey(search, surface, item);
  const Vec3 tissue = PointOf(contact, search.candidates.positions);
  const Vec3 stretch = FindStretch(search, key, contact.normal);
  const Vec3 stuck = tissue + stretch;
  ContactLink link;
  link.key = key;
  link.hand = search.motion.hand;
  link.surface = static_cast<std::uint8_t>(surface);
  link.is_pinch = IsPinch(*search.motion.tool, search.body, search.motion.X_world_device, contact.normal);
  // what lies between blades is not squeezed out
  if (link.is_pinch && ClosesAroundTubes(*search.motion.tool)) return;
  link.p_device = p_device;
  link.p_tool_stuck = math::Inverse(search.motion.X_world_device) * stuck;
  const double device_offset = math::Dot(contact.normal, p_device) + contact.reach;
  const double offset = std::min(device_offset, math::Dot(contact.normal, tissue) + search.most_push);
  link.held_back = device_offset - offset;
  AddSpring({contact.nodes, contact.weights, contact.normal, offset, search.settings.stiffness}, link,
            contacts);
  const double length = math::Norm(stretch);
  if (!(length > kSamePoint)) return;
  const Vec3 along = stretch / length;
  link.is_friction = true;
  AddSpring({contact.nodes, contact.weights, along, math::Dot(along, stuck), search.settings.stiffness}, link,
            contacts);
}

/// What bore in the last tick goes half way to where the surfaces are nearest now: along an edge that lies nearly along the
/// tool that place is ill-conditioned, and would leap to and fro with every solve.
void SmoothContactPoint(const Search& search, std::size_t surface, std::uint32_t item,
                        ContactPoint& contact) noexcept {
  const std::ptrdiff_t at = FindLast(search.last, MakeKey(search, surface, item));
  if (at < 0 || contact.time < 0.0) return;
  const tissue::ContactSpring& before = search.last.springs[static_cast<std::size_t>(at)];
  if (!(search.last.links[static_cast<std::size_t>(at)].normal_force > 0.0) || before.nodes != contact.nodes)
    return;
  ContactPoint steady = contact;
  for (int i = 0; i < 3; ++i) steady.weights[i] = 0.5 * (before.weights[i] + contact.weights[i]);
  const Segment axis = search.way.At(contact.time);
  const Vec3 tissue = PointOf(steady, search.candidates.positions);
  steady.parameter = geometry::FindNearestOnSegment(tissue, axis.start, axis.end);
  const Vec3 away = tissue - math::Lerp(axis.start, axis.end, steady.parameter);
  const double distance = math::Norm(away);
  if (!(distance > kSamePoint)) return;
  steady.normal = away / distance;
  contact = steady;
}

bool Overlaps(const geometry::Box& box, const Capsule& capsule) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::min(capsule.axis.start[axis], capsule.axis.end[axis]) - capsule.radius;
    const double high = std::max(capsule.axis.start[axis], capsule.axis.end[axis]) + capsule.radius;
    if (high < box.min[axis] || low > box.max[axis]) return false;
  }
  return true;
}

/// Whether some corner went farther in the last solve than springs are made ahead.
bool HasSnapped(const Search& search, std::span<const std::uint32_t> nodes) noexcept {
  const double margin2 = search.settings.margin * search.settings.margin;
  return std::any_of(nodes.begin(), nodes.end(), [&](std::uint32_t node) {
    return math::SquaredDistance(search.candidates.positions[node],
                                 search.candidates.positions_before[node]) > margin2;
  });
}

/// \return false where the body does not come near the triangle, or only from inside of the organ
bool FindTriangleContact(const Search& search, const std::array<std::uint32_t, 3>& nodes,
                         ContactPoint& contact) noexcept {
  const auto corners = [&](std::span<const Vec3> positions) {
    return std::array<Vec3, 3>{positions[nodes[0]], positions[nodes[1]], positions[nodes[2]]};
  };
  const auto take = [&](const collision::TriangleSweep& sweep, const std::array<Vec3, 3>& at) {
    const Vec3 away = sweep.points.on_triangle.point - sweep.points.on_segment;
    const double distance = math::Norm(away);
    if (!(distance > kSamePoint)) return false;
    const Vec3 outward = math::Cross(at[1] - at[0], at[2] - at[0]);
    // a fold may turn its back on the tool, and is no less in the way; from inside of an organ it is its other wall
    if (!search.is_outside && !(math::Dot(away, outward) < 0.0)) return false;
    contact = {nodes,
               sweep.points.on_triangle.weights,
               sweep.points.parameter,
               away / distance,
               search.radius,
               sweep.time + std::max(0.0, distance - search.radius)};
    return true;
  };
  const std::array<Vec3, 3> now = corners(search.candidates.positions);
  const auto sweep = collision::SweepToTriangle(search.way, {now, now}, search.radius);
  const bool is_near =
      sweep.is_hit || std::sqrt(sweep.points.squared_distance) < search.radius + search.settings.margin;
  if (is_near && take(sweep, now)) {
    contact.time = sweep.time;
    return true;
  }
  // tissue that shot past the tool in the last solve is met where it passed
  if (!HasSnapped(search, nodes)) return false;
  const std::array<Vec3, 3> before = corners(search.candidates.positions_before);
  const collision::MovingTriangle moving{before, now};
  const auto passed = collision::SweepToTriangle(search.way_before, moving, search.radius);
  return passed.is_hit && take(passed, moving.At(passed.time));
}

bool FindPieceContact(const Search& search, const collision::TubePiece& piece, std::uint32_t other,
                      ContactPoint& contact) noexcept {
  const auto axis = [&](std::span<const Vec3> positions) {
    return Segment{positions[piece.a], positions[piece.b]};
  };
  const double reach = search.radius + piece.radius;
  const auto take = [&](const collision::TubeSweep& sweep) {
    const Vec3 away = sweep.points.on_b - sweep.points.on_a;
    const double distance = math::Norm(away);
    if (!(distance > kSamePoint)) return false;
    const double t = sweep.points.parameter_b;
    contact = {
        {piece.a, piece.b, other}, {1.0 - t, t, 0.0}, sweep.points.parameter_a, away / distance, reach};
    return true;
  };
  const Segment now = axis(search.candidates.positions);
  const std::uint32_t nodes[2] = {piece.a, piece.b};
  if (HasSnapped(search, nodes)) {
    const auto passed =
        collision::SweepToSegment(search.way_before, {axis(search.candidates.positions_before), now}, reach);
    if (passed.is_hit && passed.time > 0.0) return take(passed);
  }
  const auto sweep = collision::SweepToSegment(search.way, {now, now}, reach);
  const bool is_near =
      sweep.is_hit || std::sqrt(sweep.points.squared_distance) < reach + search.settings.margin;
  return is_near && take(sweep);
}

/// Whether the proxy of a body lies outside of an organ: it may have been folded over it.
bool IsOutside(const Search& search, const OrganSurface& organ, double reach) noexcept {
  const auto nodes = organ.Nodes(search.candidates.positions);
  const auto near = organ.tree.FindNearestToSegment(nodes, search.way.from, {.max_distance = reach});
  if (!near.Found()) return true;
  const auto side =
      collision::FindSide(nodes, organ.triangles, organ.vertex_triangles, near.on_segment, near.nearest);
  return side.distance > 0.0;
}

/// A body that lies inside of an organ all the same pushes the wall that is nearest to it back across itself.
void PushOut(const Search& search, const OrganSurface& organ, std::size_t surface,
             ContactSet& contacts) noexcept {
  const auto nodes = organ.Nodes(search.candidates.positions);
  const auto& axis = search.way.from;
  const auto near = organ.tree.FindNearestToSegment(nodes, axis, {.max_distance = search.radius});
  if (!near.Found()) return;
  const auto& t = organ.triangles[near.nearest.triangle];
  const Vec3 outward = math::Cross(nodes[t[1]] - nodes[t[0]], nodes[t[2]] - nodes[t[0]]);
  const Vec3 normal = math::Normalized(outward, Vec3{});
  if (!(math::SquaredNorm(normal) > 0.0)) return;
  const ContactPoint contact{{organ.first_node + t[0], organ.first_node + t[1], organ.first_node + t[2]},
                             near.nearest.weights,
                             near.parameter,
                             -normal,
                             search.radius};
  AddContact(search, contact, surface, near.nearest.triangle, contacts);
}

std::array<std::uint32_t, 3> NodesOf(const OrganSurface& organ, std::uint32_t triangle) noexcept {
  std::array<std::uint32_t, 3> nodes = organ.triangles[triangle];
  for (std::uint32_t& node : nodes) node += organ.first_node;
  return nodes;
}

/// Leaves the triangles that are met first, ascending. \return how many
std::size_t KeepFirstMet(const Search& search, const OrganSurface& organ,
                         std::span<std::uint32_t> found) noexcept {
  std::array<std::pair<double, std::uint32_t>, kMostCandidates> met;
  std::size_t count = 0;
  for (const std::uint32_t triangle : found) {
    ContactPoint contact;
    if (FindTriangleContact(search, NodesOf(organ, triangle), contact))
      met[count++] = {contact.rank, triangle};
  }
  const std::size_t kept = std::min(count, kMostByBody);
  std::partial_sort(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(kept),
                    met.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < kept; ++i) found[i] = met[i].second;
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept));
  return kept;
}

void FindOnOrgan(Search& search, std::size_t surface, ContactSet& contacts) noexcept {
  const OrganSurface& organ = search.candidates.organs[surface];
  const double motion = std::min(kMostMotion, search.candidates.surface_motion[surface]);
  const double allowance = search.settings.margin + (motion > search.settings.margin ? motion : 0.0);
  const Capsule swept = collision::CalcSweptCapsule(search.way, search.radius + allowance);
  if (!Overlaps(organ.box, swept)) return;
  std::array<std::uint32_t, kMostCandidates> found;
  const std::size_t count = organ.tree.FindWithin(organ.Nodes(search.candidates.positions), swept, found);
  contacts.dropped += count > found.size() ? count - found.size() : 0;
  const std::size_t before = contacts.springs.size();
  search.is_outside = count == 0 || IsOutside(search, organ, search.radius + allowance);
  std::size_t kept = std::min(count, found.size());
  if (kept > kMostByBody) kept = KeepFirstMet(search, organ, std::span(found).first(kept));
  for (std::size_t i = 0; i < kept; ++i) {
    ContactPoint contact;
    if (!FindTriangleContact(search, NodesOf(organ, found[i]), contact)) continue;
    SmoothContactPoint(search, surface, found[i], contact);
    AddContact(search, contact, surface, found[i], contacts);
  }
  if (count > 0 && contacts.springs.size() == before) PushOut(search, organ, surface, contacts);
}

void FindOnTubes(const Search& search, ContactSet& contacts) noexcept {
  const TubeSet& set = *search.candidates.tubes;
  const std::size_t organ_count = search.candidates.organs.size();
  const double motion = std::min(kMostMotion, search.candidates.surface_motion[organ_count]);
  const double allowance = search.settings.margin + (motion > search.settings.margin ? motion : 0.0);
  const Capsule swept = collision::CalcSweptCapsule(search.way, search.radius + allowance);
  std::array<std::uint32_t, kMostCandidates> found;
  const std::size_t count = set.tree.FindWithin(search.candidates.positions, swept, found);
  contacts.dropped += count > found.size() ? count - found.size() : 0;
  for (std::size_t i = 0; i < std::min(count, found.size()); ++i) {
    const std::uint32_t tube = set.tube_of_piece[found[i]];
    const std::size_t surface = organ_count + tube;
    if (search.body != ToolBody::kShaft &&
        static_cast<std::int32_t>(surface) == search.motion.grasped_surface)
      continue;
    const collision::TubePiece& piece = set.tree.Pieces()[found[i]];
    // a spring has three nodes; the third, which bears nothing, is any other
    std::uint32_t other = 0;
    while (other == piece.a || other == piece.b) ++other;
    ContactPoint contact;
    if (FindPieceContact(search, piece, other, contact))
      AddContact(search, contact, surface, found[i], contacts);
  }
}

}  // namespace

std::array<Capsule, kToolBodyCount> CalcToolBodies(const instrument::Tool& tool, double jaw,
                                                   const math::Pose& X_world_tool) noexcept {
  const auto shapes = instrument::CalcCapsules(tool, jaw, tool.shaft_length);
  std::array<Capsule, kToolBodyCount> bodies;
  const instrument::Capsule* const parts[] = {&shapes.upper_jaw, &shapes.lower_jaw, &shapes.shaft};
  for (int i = 0; i < kToolBodyCount; ++i) {
    bodies[i] = {{X_world_tool * parts[i]->a, X_world_tool * parts[i]->b}, parts[i]->radius};
  }
  // round ends lie where the metal ends: the jaws' at their tips, the shaft's at the hinge
  for (Capsule& body : bodies) {
    const double length = math::Distance(body.axis.start, body.axis.end);
    body.axis.start = math::Lerp(body.axis.start, body.axis.end, std::min(1.0, body.radius / length));
  }
  return bodies;
}

bool HasJaws(const instrument::Tool& tool) noexcept {
  return tool.max_jaw > 0.0;
}

bool HasBody(const instrument::Tool& tool, ToolBody body) noexcept {
  return HasJaws(tool) || body != ToolBody::kLowerJaw;
}

bool ClosesAroundTubes(const instrument::Tool& tool) noexcept {
  return instrument::AbilitiesOf(tool.kind).bites;
}

bool IsPinch(const instrument::Tool& tool, ToolBody body, const math::Pose& X_world_tool,
             const Vec3& normal) noexcept {
  constexpr double kInwards = 0.5;  // within 60 degrees of the direction in which the jaw closes
  if (body == ToolBody::kShaft || !HasJaws(tool)) return false;
  const double opening = math::Dot(normal, math::Rotate(X_world_tool.rotation, {0, 1, 0}));
  return body == ToolBody::kUpperJaw ? opening < -kInwards : opening > kInwards;
}

ContactSet::ContactSet() {
  springs.reserve(kCapacity);
  links.reserve(kCapacity);
}

void ContactSet::Clear() noexcept {
  springs.clear();
  links.clear();
  dropped = 0;
}

void FindContacts(const ToolMotion& motion, const ContactCandidates& candidates,
                  const ContactSettings& settings, const ContactSet& last, ContactSet& contacts) noexcept {
  TROCAR_ASSERT(candidates.surface_motion.size() == candidates.organs.size() + 1);
  const auto before = CalcToolBodies(*motion.tool, motion.jaw_before, motion.X_world_proxy_before);
  const auto proxy = CalcToolBodies(*motion.tool, motion.jaw_before, motion.X_world_proxy);
  const auto device = CalcToolBodies(*motion.tool, motion.jaw, motion.X_world_device);
  const double most_push = FindLastDepth(last, motion.hand, settings.stiffness) + kMostPush;
  for (int body = 0; body < kToolBodyCount; ++body) {
    if (!HasBody(*motion.tool, static_cast<ToolBody>(body))) continue;
    Search search{motion,
                  candidates,
                  settings,
                  last,
                  static_cast<ToolBody>(body),
                  {proxy[body].axis, device[body].axis},
                  {before[body].axis, proxy[body].axis},
                  device[body].radius,
                  most_push};
    for (std::size_t surface = 0; surface < candidates.organs.size(); ++surface) {
      const bool is_in_jaws =
          search.body != ToolBody::kShaft && static_cast<std::int32_t>(surface) == motion.grasped_surface;
      if (!is_in_jaws) FindOnOrgan(search, surface, contacts);
    }
    const bool slips_around = search.body != ToolBody::kShaft && ClosesAroundTubes(*motion.tool);
    if (candidates.tubes != nullptr && !slips_around) FindOnTubes(search, contacts);
  }
}

ContactReaction CalcContactReaction(std::uint8_t hand, std::span<const Vec3> positions,
                                    ContactSet& contacts) noexcept {
  ContactReaction reaction;
  for (std::size_t i = 0; i < contacts.springs.size(); ++i) {
    ContactLink& link = contacts.links[i];
    if (link.hand != hand) continue;
    const tissue::ContactSpring& spring = contacts.springs[i];
    const double depth = tissue::CalcContactDepth(spring, positions);
    link.normal_force = !link.is_friction && depth > 0.0 ? spring.stiffness * depth : 0.0;
    if (!(depth > 0.0)) continue;
    reaction.force -= (spring.stiffness * depth) * spring.normal;
    if (!link.is_friction && depth > reaction.deepest) {
      reaction.deepest = depth;
      reaction.surface = link.surface;
    }
  }
  return reaction;
}

namespace {

void VisitSpring(base::StateArchive& archive, tissue::ContactSpring& spring) {
  archive.Field("nodes", spring.nodes);
  archive.Field("weights", spring.weights);
  archive.Field("normal", spring.normal);
  archive.Field("offset", spring.offset);
  archive.Field("stiffness", spring.stiffness);
}

void VisitLink(base::StateArchive& archive, ContactLink& link) {
  archive.Field("key", link.key);
  archive.Field("hand", link.hand);
  archive.Field("surface", link.surface);
  archive.Field("is_friction", link.is_friction);
  archive.Field("is_pinch", link.is_pinch);
  archive.Field("p_device", link.p_device);
  archive.Field("held_back", link.held_back);
  archive.Field("p_tool_stuck", link.p_tool_stuck);
  archive.Field("normal_force", link.normal_force);
}

}  // namespace

void VisitState(base::StateArchive& archive, ContactSet& contacts) {
  std::uint64_t count = contacts.links.size();
  archive.Field("count", count);
  archive.Field("dropped", contacts.dropped);
  if (archive.IsRestoring()) {
    if (count > ContactSet::kCapacity) {
      archive.Fail("has more contacts than its capacity");
      return;
    }
    contacts.springs.resize(count);
    contacts.links.resize(count);
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    VisitSpring(archive, contacts.springs[i]);
    VisitLink(archive, contacts.links[i]);
  }
}

}  // namespace trocar::surgery
