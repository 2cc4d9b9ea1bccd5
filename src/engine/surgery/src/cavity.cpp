// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/cavity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/state_archive.h"
#include "trocar/math/small_solver.h"
#include "trocar/surgery/organ_contact.h"

namespace trocar::surgery {

using math::Vec3;

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
/// A face that curves less or more is no diaphragm [m].
constexpr double kSmallestRadius = 0.02, kLargestRadius = 0.5;
/// Springs are made at most this far ahead [m].
constexpr double kMostMotion = 0.02;

/// y = c0 + c1 x + c2 z + c3 x^2 + c4 z^2 over the upper half of the points: the flanks are no part of a roof.
void FitDome(std::span<const Vec3> points, Cavity& cavity) {
  if (points.size() < kLeastDomePoints) return;
  std::vector<Vec3> upper(points.begin(), points.end());
  std::stable_sort(upper.begin(), upper.end(), [](const Vec3& a, const Vec3& b) { return a.y > b.y; });
  upper.resize((upper.size() + 1) / 2);
  std::vector<math::SmallVector<5>> rows;
  std::vector<double> heights;
  for (const Vec3& p : upper) {
    rows.push_back({1.0, p.x, p.z, p.x * p.x, p.z * p.z});
    heights.push_back(p.y);
  }
  const auto c = math::SolveLeastSquares<5>(rows, heights);
  const auto is_dome = [](double square) {
    return -2.0 * square * kLargestRadius > 1.0 && -2.0 * square * kSmallestRadius < 1.0;
  };
  if (!is_dome(c[3]) || !is_dome(c[4])) return;
  cavity.dome_across = -c[3], cavity.dome_deep = -c[4];
  cavity.dome_x = -0.5 * c[1] / c[3], cavity.dome_z = -0.5 * c[2] / c[4];
  cavity.dome_top = c[0] + cavity.dome_across * cavity.dome_x * cavity.dome_x +
                    cavity.dome_deep * cavity.dome_z * cavity.dome_z;
  cavity.has_dome = true;
}

}  // namespace

std::array<CavityClearance, kCavityParts> Cavity::FindClearances(const Vec3& p) const noexcept {
  std::array<CavityClearance, kCavityParts> clearances;
  for (CavityClearance& clearance : clearances) clearance = {kFar, {0, 0, 1}};
  if (has_wall) {
    const Vec3 slope{2.0 * across * p.x, 2.0 * along * p.y, 1.0};
    const double size = math::Norm(slope);
    clearances[0] = {(wall_top - across * p.x * p.x - along * p.y * p.y - p.z) / size, -slope / size};
  }
  if (has_dome) {
    const double x = p.x - dome_x, z = p.z - dome_z;
    const Vec3 slope{2.0 * dome_across * x, 1.0, 2.0 * dome_deep * z};
    const double size = math::Norm(slope);
    clearances[1] = {(dome_top - dome_across * x * x - dome_deep * z * z - p.y) / size, -slope / size};
  }
  if (has_floor) clearances[2] = {p.z - floor, {0, 0, 1}};
  return clearances;
}

Cavity FitCavity(std::span<const Vec3> ports, std::span<const Vec3> diaphragm, std::span<const Vec3> organs) {
  Cavity cavity;
  cavity.has_wall = !ports.empty();
  for (const Vec3& port : ports) {
    const double top = port.z + cavity.across * port.x * port.x + cavity.along * port.y * port.y;
    cavity.wall_top += top / static_cast<double>(ports.size());
  }
  FitDome(diaphragm, cavity);
  cavity.has_floor = !organs.empty();
  if (cavity.has_floor) {
    cavity.floor = std::min_element(organs.begin(), organs.end(), [](const Vec3& a, const Vec3& b) {
                     return a.z < b.z;
                   })->z;
  }
  return cavity;
}

CavityContact MakeCavityContact(const Cavity& cavity, std::span<const OrganSurface> organs,
                                std::span<const Vec3> positions, std::span<const std::uint8_t> is_fixed,
                                std::uint8_t organ, const CavityContactSettings& settings) {
  CavityContact made;
  made.organ = organ;
  UpdateTopology(cavity, organs, positions, settings, made);
  const auto own = is_fixed.subspan(organs[organ].first_node, organs[organ].node_count);
  made.is_held.assign(own.begin(), own.end());
  return made;
}

void UpdateTopology(const Cavity& cavity, std::span<const OrganSurface> organs,
                    std::span<const Vec3> positions, const CavityContactSettings& settings,
                    CavityContact& contact) {
  const OrganSurface& surface = organs[contact.organ];
  if (contact.allowed.size() > surface.node_count) contact.allowed.resize(surface.node_count);  // uncut again
  for (std::size_t i = contact.allowed.size(); i < surface.node_count; ++i) {
    const auto clearances = cavity.FindClearances(positions[surface.first_node + i]);
    std::array<double, kCavityParts>& allowed = contact.allowed.emplace_back();
    for (int part = 0; part < kCavityParts; ++part)
      allowed[part] = std::min(0.0, clearances[part].distance) - settings.play;
  }
  contact.is_held.resize(surface.node_count, 0);
}

void FindCavityContacts(const Cavity& cavity, std::span<const OrganSurface> organs,
                        std::span<const Vec3> positions, std::span<const Vec3> positions_before,
                        const CavityContactSettings& settings, const CavityContact& contact,
                        ContactSet& contacts) noexcept {
  const OrganSurface& surface = organs[contact.organ];
  // what lies still at a wall has the whole play left
  constexpr double kShareOfPlay = 0.9;
  // a spring has three nodes; two of them bear nothing
  const std::uint32_t first = surface.first_node;
  for (std::uint32_t i = 0; i < surface.node_count; ++i) {
    if (contact.is_held[i] != 0) continue;
    const Vec3& p = positions[first + i];
    const auto clearances = cavity.FindClearances(p);
    for (int part = 0; part < kCavityParts; ++part) {
      const double clearance = clearances[part].distance - contact.allowed[i][part];
      const double outwards = -math::Dot(clearances[part].inwards, p - positions_before[first + i]);
      if (!(clearance < kShareOfPlay * settings.play + std::clamp(outwards, 0.0, kMostMotion))) continue;
      if (contacts.springs.size() == ContactSet::kCapacity) {
        ++contacts.dropped;
        continue;
      }
      const std::uint32_t other = i > 0 ? first : first + 1, third = i > 1 ? first + 1 : first + 2;
      contacts.springs.push_back({{first + i, other, third},
                                  {1.0, 0.0, 0.0},
                                  clearances[part].inwards,
                                  math::Dot(clearances[part].inwards, p) - clearance,
                                  settings.stiffness});
      ContactLink link;
      link.hand = kNoHand;
      link.key = ~std::uint64_t{0};
      link.surface = contact.organ;
      contacts.links.push_back(link);
    }
  }
}

void VisitState(base::StateArchive& archive, CavityContact& contact) {
  archive.FixedField("allowed", contact.allowed);
  archive.FixedField("is_held", contact.is_held);
}

}  // namespace trocar::surgery
