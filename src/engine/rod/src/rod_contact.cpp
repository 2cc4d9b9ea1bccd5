// SPDX-License-Identifier: Apache-2.0
#include "trocar/rod/rod_contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "crossing_points.h"
#include "trocar/math/state_fields.h"
#include "trocar/rod/rod.h"

namespace trocar::base {
template <>
inline constexpr bool kIsPlainState<rod::RodContact> = sizeof(rod::RodContact) ==
                                                       2 * sizeof(std::uint32_t) + 10 * sizeof(double);
template <>
inline constexpr bool kIsPlainState<rod::RodCrossing> = sizeof(rod::RodCrossing) ==
                                                        2 * sizeof(std::uint32_t) + 9 * sizeof(double);
}  // namespace trocar::base

namespace trocar::rod {

using math::Vec3;

namespace {

/// Where two segments come nearest: places on them, 0 to 1.
struct Nearest {
  double on_rod, on_axis;
};

/// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.9.
Nearest FindNearest(const Vec3& p, const Vec3& along_rod, const Vec3& a, const Vec3& along_axis) noexcept {
  const Vec3 apart = p - a;
  const double rr = math::SquaredNorm(along_rod), aa = math::SquaredNorm(along_axis);
  const double rd = math::Dot(along_rod, apart), ad = math::Dot(along_axis, apart);
  if (!(aa > 0.0)) return {std::clamp(-rd / rr, 0.0, 1.0), 0.0};
  const double ra = math::Dot(along_rod, along_axis), both = rr * aa - ra * ra;
  // of parallel segments the middle
  double on_rod = both > 1e-12 * rr * aa ? std::clamp((ra * ad - rd * aa) / both, 0.0, 1.0) : 0.5;
  double on_axis = (ra * on_rod + ad) / aa;
  if (on_axis < 0.0 || on_axis > 1.0) {
    on_axis = std::clamp(on_axis, 0.0, 1.0);
    on_rod = std::clamp((ra * on_axis - rd) / rr, 0.0, 1.0);
  }
  return {on_rod, on_axis};
}

/// Direction from b's point to a's; square to both segments where the points are one.
Vec3 CalcNormal(std::span<const Vec3> position, const RodCrossing& c) noexcept {
  return math::Normalized(
      CalcApart(position, c),
      math::Normalized(math::Cross(position[c.a + 1] - position[c.a], position[c.b + 1] - position[c.b])));
}

/// \return how far the surfaces are apart [m]
double Touch(const Vec3& p, const Vec3& q, const RodObstacle& obstacle, double rod_radius,
             RodContact& contact) noexcept {
  const Vec3 along = q - p;
  if (math::SquaredNorm(obstacle.outward) > 0.0) {
    contact.normal = obstacle.outward;
    const double of_p = math::Dot(contact.normal, p), of_q = math::Dot(contact.normal, q);
    contact.at = of_p < of_q ? 0.0 : of_p > of_q ? 1.0 : 0.5;
    contact.offset = math::Dot(contact.normal, obstacle.a) + rod_radius;
    return math::Min(of_p, of_q) - contact.offset;
  }
  const Vec3 axis = obstacle.b - obstacle.a;
  const Nearest nearest = FindNearest(p, along, obstacle.a, axis);
  const Vec3 on_rod = p + nearest.on_rod * along, on_axis = obstacle.a + nearest.on_axis * axis;
  const double distance = math::Distance(on_rod, on_axis), reach = obstacle.radius + rod_radius;
  contact.at = nearest.on_rod;
  contact.normal = math::Normalized(on_rod - on_axis, math::AnyPerpendicular(math::Normalized(along)));
  contact.offset = math::Dot(contact.normal, on_axis) + reach;
  return distance - reach;
}

}  // namespace

void FollowContacts(const RodModel& model, const RodState& state, std::span<const RodObstacle> obstacles,
                    const RodContactSettings& settings, std::vector<RodContact>& contacts) {
  const auto is_before = [](const RodContact& a, const RodContact& b) {
    return a.segment != b.segment ? a.segment < b.segment : a.obstacle < b.obstacle;
  };
  const std::size_t before = contacts.size();
  for (std::uint32_t segment = 0; segment < model.SegmentCount(); ++segment) {
    const Vec3 &p = state.position[segment], &q = state.position[segment + 1];
    for (std::uint32_t o = 0; o < obstacles.size(); ++o) {
      RodContact contact{.segment = segment, .obstacle = o};
      if (Touch(p, q, obstacles[o], model.material.radius, contact) > settings.margin) continue;
      contact.friction = obstacles[o].friction;
      contact.anchor = math::Lerp(p, q, contact.at);
      const auto old = contacts.begin() + static_cast<std::ptrdiff_t>(before);
      const auto same = std::lower_bound(contacts.begin(), old, contact, is_before);
      if (same != old && !is_before(contact, *same) && same->pressure > 0.0) {
        // the spring stays as long as it was, though another point of the segment is nearest now and the thing has moved
        contact.anchor += same->anchor + obstacles[o].motion - math::Lerp(p, q, same->at);
        contact.pressure = same->pressure;
      }
      contacts.push_back(contact);
    }
  }
  contacts.erase(contacts.begin(), contacts.begin() + static_cast<std::ptrdiff_t>(before));
}

void MoveCrossing(std::span<const Vec3> position, RodCrossing& crossing) noexcept {
  const Vec3 before = CalcApart(position, crossing);
  const Nearest nearest = FindNearest(position[crossing.a], position[crossing.a + 1] - position[crossing.a],
                                      position[crossing.b], position[crossing.b + 1] - position[crossing.b]);
  crossing.at_a = nearest.on_rod, crossing.at_b = nearest.on_axis;
  const Vec3 normal = CalcNormal(position, crossing);
  crossing.normal = math::Dot(normal, crossing.normal) < 0.0 ? -normal : normal;
  const Vec3 now = CalcApart(position, crossing);
  crossing.anchor = crossing.pressure > 0.0 ? crossing.anchor + now - before : now;
}

void FollowCrossings(const RodModel& model, const RodState& state, const RodContactSettings& settings,
                     std::vector<RodCrossing>& crossings) {
  const auto is_before = [](const RodCrossing& x, const RodCrossing& y) {
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  };
  const std::size_t before = crossings.size();
  const double reach = 2.0 * model.material.radius + settings.margin;
  const auto segments = static_cast<std::uint32_t>(model.SegmentCount());
  for (std::uint32_t a = 0; a < segments; ++a) {
    const Vec3 &pa = state.position[a], &qa = state.position[a + 1];
    const Vec3 middle = 0.5 * (pa + qa);
    for (std::uint32_t b = a + kLeastApart; b < segments; ++b) {
      const Vec3 &pb = state.position[b], &qb = state.position[b + 1];
      const double far = reach + 0.75 * (model.length[a] + model.length[b]);
      if (math::SquaredDistance(middle, 0.5 * (pb + qb)) > far * far) continue;
      const Nearest nearest = FindNearest(pa, qa - pa, pb, qb - pb);
      const auto old = crossings.begin() + static_cast<std::ptrdiff_t>(before);
      RodCrossing crossing{.a = a, .b = b, .at_a = nearest.on_rod, .at_b = nearest.on_axis};
      const Vec3 apart = CalcApart(state.position, crossing);
      if (math::SquaredNorm(apart) > reach * reach) continue;
      const auto same = std::lower_bound(crossings.begin(), old, crossing, is_before);
      if (same != old && !is_before(crossing, *same)) {
        crossing = *same;
        MoveCrossing(state.position, crossing);
      } else {
        crossing.normal = CalcNormal(state.position, crossing);
        crossing.anchor = apart;
      }
      crossings.push_back(crossing);
    }
  }
  crossings.erase(crossings.begin(), crossings.begin() + static_cast<std::ptrdiff_t>(before));
}

void VisitState(base::StateArchive& archive, std::vector<RodCrossing>& crossings) {
  archive.Field("crossings", crossings);
}

void VisitState(base::StateArchive& archive, std::vector<RodContact>& contacts) {
  archive.Field("contacts", contacts);
}

}  // namespace trocar::rod
