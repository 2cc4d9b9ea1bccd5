// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/neighbour_contact.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/math/state_fields.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

/// Of each contact spring. Softer than tissue's: no solver gives way here, and several triangles answer one tool [N/m].
constexpr double kContactStiffness = 120.0;
/// Part of the way to its new place that a dent goes in a tick: less than 2 / (1 + contact stiffness / stiffness), with room for
/// some triangles at once, so that surface and tool come to rest on each other [-].
constexpr double kDentRate = 0.12;
/// A dent less deep than this is none [m].
constexpr double kNoDent = 1e-6;

}  // namespace

Vec3 Dent::ShiftOf(const Vec3& p) const noexcept {
  const double share = math::SquaredDistance(p, centre) / (kDentRadius * kDentRadius);
  if (!(share < 1.0)) return {};
  return ((1.0 - share) * (1.0 - share)) * push;
}

base::Result<NeighbourContact> NeighbourContact::Make(std::span<const NeighbourSurface> surfaces) {
  NeighbourContact made;
  made.settings_.stiffness = kContactStiffness;
  for (const NeighbourSurface& surface : surfaces)
    made.rest_.insert(made.rest_.end(), surface.mesh.positions.begin(), surface.mesh.positions.end());
  std::uint32_t first = 0;
  for (const NeighbourSurface& surface : surfaces) {
    auto organ = MakeOrganSurface(made.rest_, first, surface.mesh);
    if (!organ.ok()) return organ.error();
    UpdateOrganSurface(*organ, made.rest_);
    first += organ->node_count;
    made.surfaces_.push_back(std::move(*organ));
    made.compliance_.push_back(surface.stiffness > 0 ? 1.0 / surface.stiffness : 0.0);
    made.deepest_.push_back(surface.deepest);
  }
  made.positions_ = made.positions_before_ = made.rest_;
  made.motion_.assign(surfaces.size() + 1, 0.0);
  made.is_dented_.assign(surfaces.size(), 0);
  return made;
}

void NeighbourContact::Reset() noexcept {
  dents_ = dents_before_ = {};
  forces_ = {};
  contacts_.Clear();
  last_.Clear();
  Place();
}

ContactCandidates NeighbourContact::Candidates() const noexcept {
  return {surfaces_, nullptr, positions_, positions_before_, motion_};
}

void NeighbourContact::Find(std::span<const ToolMotion> motions) noexcept {
  std::swap(contacts_, last_);
  contacts_.Clear();
  const ContactCandidates candidates = Candidates();
  for (ToolMotion motion : motions) {
    motion.grasped_surface = -1;
    FindContacts(motion, candidates, settings_, last_, contacts_);
  }
}

void NeighbourContact::Press(bool is_good) noexcept {
  dents_before_ = dents_;
  for (int hand = 0; hand < kDentCount; ++hand) {
    Vec3& force = forces_[static_cast<std::size_t>(hand)];
    const ContactReaction reaction =
        CalcContactReaction(static_cast<std::uint8_t>(hand), positions_, contacts_);
    force = is_good ? reaction.force : Vec3{};
    if (!is_good) continue;
    Dent& dent = dents_[static_cast<std::size_t>(hand)];
    // where the surface is pressed most
    Vec3 place;
    double most = 0;
    for (std::size_t i = 0; i < contacts_.springs.size(); ++i) {
      const ContactLink& link = contacts_.links[i];
      if (link.hand != hand || link.is_friction || link.surface != reaction.surface) continue;
      if (!(link.normal_force > most)) continue;
      const tissue::ContactSpring& spring = contacts_.springs[i];
      most = link.normal_force;
      place = {};
      for (std::size_t k = 0; k < spring.nodes.size(); ++k)
        place += spring.weights[k] * rest_[spring.nodes[k]];
    }
    const bool is_pressed = most > 0;
    if (is_pressed &&
        (dent.neighbour != reaction.surface || math::Distance(dent.centre, place) > 0.5 * kDentRadius)) {
      // another place: the old dent springs back, which the sweep of the next tick sees
      dent = {reaction.surface, place, {}};
    }
    if (dent.neighbour < 0) continue;
    if (is_pressed) dent.centre = math::Lerp(dent.centre, place, kDentRate);
    const auto neighbour = static_cast<std::size_t>(dent.neighbour);
    Vec3 wanted = is_pressed ? -compliance_[neighbour] * reaction.force : Vec3{};
    if (const double depth = math::Norm(wanted); depth > deepest_[neighbour])
      wanted = (deepest_[neighbour] / depth) * wanted;
    dent.push += kDentRate * (wanted - dent.push);
    if (!is_pressed && math::Norm(dent.push) < kNoDent) dent = {};
  }
  if (!is_good) contacts_.Clear();
  Place();
}

void NeighbourContact::AddLimits(int hand, ProxyLimits& limits) const noexcept {
  AddContactLimits(static_cast<std::uint8_t>(hand), contacts_, positions_, limits);
}

/// Surfaces as the dents have them, now and before.
void NeighbourContact::Place() noexcept {
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    const auto is_of = [&](const Dent& dent) { return dent.neighbour == index; };
    const bool is_dented = std::any_of(dents_.begin(), dents_.end(), is_of) ||
                           std::any_of(dents_before_.begin(), dents_before_.end(), is_of);
    motion_[i] = 0;
    if (!is_dented && is_dented_[i] == 0) continue;
    OrganSurface& surface = surfaces_[i];
    double farthest2 = 0;
    for (std::uint32_t v = surface.first_node; v < surface.first_node + surface.node_count; ++v) {
      Vec3 now = rest_[v], before = rest_[v];
      for (const Dent& dent : dents_) {
        if (is_of(dent)) now += dent.ShiftOf(rest_[v]);
      }
      for (const Dent& dent : dents_before_) {
        if (is_of(dent)) before += dent.ShiftOf(rest_[v]);
      }
      positions_[v] = now;
      positions_before_[v] = before;
      farthest2 = std::max(farthest2, math::SquaredDistance(now, before));
    }
    motion_[i] = std::sqrt(farthest2);
    is_dented_[i] = is_dented ? 1 : 0;
    UpdateOrganSurface(surface, positions_);
  }
}

void NeighbourContact::VisitState(base::StateArchive& archive) {
  for (auto* dents : {&dents_, &dents_before_}) {
    for (Dent& dent : *dents) {
      archive.Field("neighbour", dent.neighbour);
      archive.Field("centre", dent.centre);
      archive.Field("push", dent.push);
    }
  }
  archive.Field("contacts", contacts_);
  if (!archive.IsRestoring() || !archive.ok()) return;
  for (const auto* dents : {&dents_, &dents_before_}) {
    for (const Dent& dent : *dents) {
      if (dent.neighbour >= static_cast<std::int32_t>(surfaces_.size())) {
        archive.Fail("a dent lies in a neighbour that there is not");
        return;
      }
    }
  }
  std::fill(is_dented_.begin(), is_dented_.end(), std::uint8_t{1});
  Place();
}

}  // namespace trocar::surgery
