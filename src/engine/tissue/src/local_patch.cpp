// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/local_patch.h"

#include <algorithm>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/math/symmetric3.h"
#include "trocar/tissue/link_stiffness.h"

namespace trocar::tissue {
namespace {

constexpr std::uint16_t kNowhere = std::numeric_limits<std::uint16_t>::max();

bool IsPrescribed(const PatchSource& source, std::uint32_t node) noexcept {
  return source.state.condition[node] == NodeCondition::kPrescribed;
}

/// Calls visit(other) for every node that `node` hangs on.
template <typename Visit>
void ForEachNeighbour(const PatchSource& source, std::uint32_t node, Visit&& visit) {
  const TissueModel& model = source.model;
  for (auto h = model.spring_starts[node]; h < model.spring_starts[node + 1]; ++h)
    visit(model.half_springs[h].other);
  for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
    if (source.state.strand_is_intact[model.half_strands[h].strand]) visit(model.half_strands[h].other);
  }
}

/// Stiffness of all that holds a node while its neighbours stand still.
math::Symmetric3 CalcNodeBlock(const PatchSource& source, std::uint32_t node) noexcept {
  const TissueModel& model = source.model;
  const math::Vec3 here = source.state.position[node];
  math::Symmetric3 block{};
  math::AddIsotropic(block, source.load.shape_scale * model.shape_stiffness[node]);
  for (auto h = model.spring_starts[node]; h < model.spring_starts[node + 1]; ++h) {
    const auto& half = model.half_springs[h];
    const math::Vec3 along = source.state.position[half.other] - here;
    const LinkStiffness link = CalcLinkStiffness(
        along, math::Norm(along), source.load.stiffness_scale * half.stiffness, half.rest_length);
    math::AddIsotropic(block, link.isotropic);
    math::AddDirection(block, link.direction, link.axial);
  }
  for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
    const auto& half = model.half_strands[h];
    if (source.state.strand_is_intact[half.strand])
      math::AddIsotropic(block, source.load.stiffness_scale * half.stiffness);
  }
  return block;
}

bool IsMine(const PatchSource& source, std::size_t contact) noexcept {
  return source.contact_tools[contact] == source.tool;
}

/// Point of the tool that presses [m].
math::Vec3 CalcPressingPoint(const ContactSpring& contact, std::span<const math::Vec3> position,
                             double depth) noexcept {
  math::Vec3 point = depth * contact.normal;
  for (int i = 0; i < 3; ++i) point += contact.weights[i] * position[contact.nodes[i]];
  return point;
}

/// A rigid shaft that slides through its trocar and turns about it: where the tip moves across by d, the point that
/// lies in the share s of the way to it moves across by s d, and along the shaft by all of it. A force there pushes the
/// tip by the transpose of that.
math::Vec3 CalcTipNormal(const PatchSource& source, const ContactSpring& contact) noexcept {
  constexpr double kShortest = 0.005;  // nearer to the trocar the tip has no lever worth the name [m]
  const math::Vec3 shaft = source.X_world_tool.translation - source.p_world_pivot;
  const double depth_of_tip = math::Norm(shaft);
  if (!source.has_pivot || !(depth_of_tip > kShortest)) return contact.normal;
  const math::Vec3 axis = shaft / depth_of_tip;
  const double depth = CalcContactDepth(contact, source.state.position);
  const math::Vec3 pressing = CalcPressingPoint(contact, source.state.position, depth);
  // jaws reach a little beyond the tip's origin; on the handle's side of the trocar nothing is pressed
  const double share = std::clamp(math::Dot(pressing - source.p_world_pivot, axis) / depth_of_tip, 0.0, 1.2);
  const math::Vec3 along = math::Dot(contact.normal, axis) * axis;
  return along + share * (contact.normal - along);
}

/// A force below this is rounding [N].
constexpr double kNoForce = 1e-9;
/// Of what pushes the tool beside tissue: another tool's shaft [N/m].
constexpr double kRestStiffness = 1000;

/// Where there is no room, the spring is joined with the one that points most nearly its way: both stiffnesses, and the force
/// along their mean.
void AddPress(const LocalPatch::Press& press, LocalPatch& patch) noexcept {
  if (patch.press_count < LocalPatch::kMaxPresses) {
    patch.presses[patch.press_count++] = press;
    return;
  }
  const auto likeness = [&](const LocalPatch::Press& other) { return math::Dot(press.normal, other.normal); };
  LocalPatch::Press& joined =
      *std::max_element(patch.presses.begin(), patch.presses.end(),
                        [&](const auto& a, const auto& b) { return likeness(a) < likeness(b); });
  const double stiffness = joined.stiffness + press.stiffness;
  const math::Vec3 push = joined.force * joined.normal + press.force * press.normal;
  joined.normal =
      (joined.stiffness / stiffness) * joined.normal + (press.stiffness / stiffness) * press.normal;
  const double size2 = math::SquaredNorm(joined.normal);
  joined.force = size2 > 0.0 ? std::max(0.0, math::Dot(push, joined.normal) / size2) : 0.0;
  joined.stiffness = stiffness;
}

}  // namespace

PatchCutter::PatchCutter(std::size_t node_count) : place_(node_count, kNowhere) {}

/// Lists the nodes and gives each its place.
struct PatchCutter::Growth {
  const PatchSource& source;
  LocalPatch& patch;
  std::vector<std::uint16_t>& place;
  bool fits = true;

  void Add(std::uint32_t node) noexcept {
    if (!fits || place[node] != kNowhere) return;
    if (patch.node_count == LocalPatch::kMaxNodes) {
      fits = false;
      return;
    }
    place[node] = static_cast<std::uint16_t>(patch.node_count);
    patch.node[patch.node_count++] = node;
  }
  void AddFree(std::uint32_t node) noexcept {
    if (!IsPrescribed(source, node)) Add(node);
  }
  void AddNeighbours(std::size_t first, std::size_t last) noexcept {
    for (std::size_t i = first; i < last && fits; ++i)
      ForEachNeighbour(source, patch.node[i], [&](std::uint32_t other) { AddFree(other); });
  }
};

bool PatchCutter::Grow(const PatchSource& source, int rings, LocalPatch& patch) noexcept {
  patch.node_count = 0;
  Growth growth{source, patch, place_};
  for (std::size_t c = 0; c < source.contacts.size(); ++c) {
    if (!IsMine(source, c)) continue;
    for (const std::uint32_t node : source.contacts[c].nodes) growth.AddFree(node);
  }
  const std::size_t pressed = patch.node_count;
  for (const std::uint32_t node : source.held)
    ForEachNeighbour(source, node, [&](std::uint32_t other) { growth.AddFree(other); });
  // what hangs on a held node is its first ring
  std::size_t first = 0, last = pressed;
  for (int ring = 0; ring < rings; ++ring) {
    growth.AddNeighbours(first, last);
    first = ring == 0 ? pressed : last;
    last = patch.node_count;
  }
  patch.free_count = patch.node_count;
  for (const std::uint32_t node : source.held) growth.Add(node);
  patch.held_count = patch.node_count - patch.free_count;
  for (std::size_t i = 0; i < patch.free_count + patch.held_count && growth.fits; ++i)
    ForEachNeighbour(source, patch.node[i], [&](std::uint32_t other) { growth.Add(other); });
  // corners of a pressed triangle that somebody else holds
  for (std::size_t c = 0; c < source.contacts.size(); ++c) {
    if (!IsMine(source, c)) continue;
    for (const std::uint32_t node : source.contacts[c].nodes) growth.Add(node);
  }
  return growth.fits && AddLinks(source, patch);
}

bool PatchCutter::AddLinks(const PatchSource& source, LocalPatch& patch) noexcept {
  const TissueModel& model = source.model;
  std::size_t count = 0;
  for (std::size_t i = 0; i < patch.free_count + patch.held_count; ++i) {
    patch.link_starts[i] = static_cast<std::uint16_t>(count);
    const std::uint32_t node = patch.node[i];
    for (auto h = model.spring_starts[node]; h < model.spring_starts[node + 1]; ++h) {
      const auto& half = model.half_springs[h];
      if (count == LocalPatch::kMaxLinks) return false;
      patch.links[count++] = {place_[half.other], false, source.load.stiffness_scale * half.stiffness,
                              half.rest_length};
    }
    for (auto h = model.strand_starts[node]; h < model.strand_starts[node + 1]; ++h) {
      const auto& half = model.half_strands[h];
      if (!source.state.strand_is_intact[half.strand]) continue;
      if (count == LocalPatch::kMaxLinks) return false;
      patch.links[count++] = {place_[half.other], true, source.load.stiffness_scale * half.stiffness, 0.0};
    }
  }
  patch.link_starts[patch.free_count + patch.held_count] = static_cast<std::uint16_t>(count);
  for (std::size_t i = 0; i < patch.node_count; ++i) {
    const std::uint32_t node = patch.node[i];
    patch.position[i] = source.state.position[node];
    patch.own_stiffness[i] = source.load.shape_scale * model.shape_stiffness[node];
  }
  return true;
}

void PatchCutter::SetLinear(const PatchSource& source, LocalPatch& patch) const noexcept {
  patch.kind = LocalPatch::Kind::kLinear;
  math::Vec3 rest = patch.force;  // that no spring gives yet [N]
  for (std::size_t c = 0; c < source.contacts.size(); ++c) {
    const ContactSpring& contact = source.contacts[c];
    if (!IsMine(source, c) || !(CalcContactDepth(contact, source.state.position) > 0.0)) continue;
    // the contact in row with what its point gives way
    double compliance = 1.0 / contact.stiffness;
    for (int i = 0; i < 3; ++i) {
      if (IsPrescribed(source, contact.nodes[i])) continue;
      const math::Symmetric3 inverse = math::Invert(CalcNodeBlock(source, contact.nodes[i]));
      compliance += contact.weights[i] * contact.weights[i] *
                    math::Dot(contact.normal, math::Multiply(inverse, contact.normal));
    }
    const double force = contact.stiffness * CalcContactDepth(contact, source.state.position);
    const math::Vec3 tip_normal = CalcTipNormal(source, contact);
    AddPress({tip_normal, force, 1.0 / compliance}, patch);
    rest += force * tip_normal;
  }
  if (source.held.empty()) {
    // another tool, or what merging left over: it pushes no farther than it has to, either
    if (const double size = math::Norm(rest); size > kNoForce)
      AddPress({-rest / size, size, kRestStiffness}, patch);
  }
  math::Symmetric3 stiffness{};
  for (const std::uint32_t node : source.held) {
    const math::Symmetric3 block = CalcNodeBlock(source, node);
    for (std::size_t i = 0; i < stiffness.size(); ++i) stiffness[i] += block[i];
  }
  const auto& [xx, xy, xz, yy, yz, zz] = stiffness;
  patch.jacobian = {math::Vec3{-xx, -xy, -xz}, math::Vec3{-xy, -yy, -yz}, math::Vec3{-xz, -yz, -zz}};
}

void PatchCutter::Cut(const PatchSource& source, LocalPatch& patch, int max_rings) noexcept {
  TROCAR_ASSERT(source.model.Size() == place_.size() &&
                source.contacts.size() == source.contact_tools.size());
  TROCAR_ASSERT(max_rings >= 1 && max_rings <= kMaxRings);
  patch.kind = LocalPatch::Kind::kNone;
  patch.is_healthy = source.is_healthy && math::IsFinite(source.force);
  patch.tick = source.tick;
  patch.X_world_tool = source.X_world_tool;
  patch.force = source.force;
  patch.has_pivot = source.has_pivot;
  patch.free_count = patch.held_count = patch.node_count = patch.contact_count = patch.press_count = 0;
  if (!patch.is_healthy) return;

  std::size_t mine = 0;
  for (std::size_t c = 0; c < source.contacts.size(); ++c) mine += IsMine(source, c) ? 1 : 0;
  if (mine == 0 && source.held.empty()) {
    patch.force = {};
    return;
  }
  // what presses the shaft is felt at the tip by its lever
  for (std::size_t c = 0; c < source.contacts.size() && source.has_pivot; ++c) {
    const ContactSpring& contact = source.contacts[c];
    const double depth = IsMine(source, c) ? CalcContactDepth(contact, source.state.position) : 0.0;
    if (depth > 0.0)
      patch.force += contact.stiffness * depth * (contact.normal - CalcTipNormal(source, contact));
  }
  bool is_cut = false;
  for (int rings = max_rings; rings >= 1 && !is_cut && mine <= LocalPatch::kMaxContacts; --rings) {
    is_cut = Grow(source, rings, patch);
    if (is_cut) {
      for (std::size_t c = 0; c < source.contacts.size(); ++c) {
        if (!IsMine(source, c)) continue;
        const ContactSpring& contact = source.contacts[c];
        const double depth = CalcContactDepth(contact, source.state.position);
        LocalPatch::Contact& copy = patch.contacts[patch.contact_count++];
        for (int i = 0; i < 3; ++i) copy.nodes[i] = place_[contact.nodes[i]];
        copy.weights = contact.weights;
        copy.normal = contact.normal;
        copy.tip_normal = CalcTipNormal(source, contact);
        copy.lever =
            CalcPressingPoint(contact, source.state.position, depth) - source.X_world_tool.translation;
        copy.depth = depth;
        copy.stiffness = contact.stiffness;
      }
    }
    for (std::size_t i = 0; i < patch.node_count; ++i) place_[patch.node[i]] = kNowhere;
  }
  patch.kind = LocalPatch::Kind::kSegment;
  if (!is_cut) SetLinear(source, patch);
}

}  // namespace trocar::tissue
