// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/sliding_constraint.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/math/state_fields.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

/// Weights of the nodes in the offset c = sum g_i x_i from the rod to the puncture [-].
std::array<double, 5> CalcOffsetWeights(const SlidingConstraint& element, double share) noexcept {
  return {element.weights[0], element.weights[1], element.weights[2], share - 1.0, -share};
}

/// Whether the nearest point is within the segment, and moves along it.
bool IsWithin(double share) noexcept {
  return share > 0.0 && share < 1.0;
}

}  // namespace

SlidePlace CalcSlidePlace(const SlidingConstraint& element, const ElementVectors<5>& position) noexcept {
  const Vec3 puncture =
      element.weights[0] * position[0] + element.weights[1] * position[1] + element.weights[2] * position[2];
  const Vec3 along = position[4] - position[3];
  const double length2 = math::SquaredNorm(along);
  SlidePlace place;
  if (length2 > 0.0)
    place.share = math::Min(math::Max(math::Dot(puncture - position[3], along) / length2, 0.0), 1.0);
  place.offset = puncture - (position[3] + place.share * along);
  return place;
}

Slide FollowSlide(std::span<const std::uint32_t> rod, std::span<const Vec3> position,
                  SlidingConstraint& element) noexcept {
  const auto at = std::adjacent_find(rod.begin(), rod.end(), [&](std::uint32_t a, std::uint32_t b) {
    return a == element.nodes[3] && b == element.nodes[4];
  });
  TROCAR_ASSERT(at != rod.end());
  const auto [share, offset] =
      CalcSlidePlace(element, GatherPositions(element, [&](std::uint32_t node) { return position[node]; }));
  if (IsWithin(share)) return Slide::kHolds;
  const auto segment = static_cast<std::size_t>(at - rod.begin());
  const bool is_last = segment + 2 == rod.size();
  if (share > 0.0 ? is_last : segment == 0) return Slide::kSlippedOut;
  const std::size_t next = share > 0.0 ? segment + 1 : segment - 1;
  element.nodes[3] = rod[next], element.nodes[4] = rod[next + 1];
  return Slide::kMoved;
}

double CalcElementEnergy(const SlidingConstraint& element, const ElementVectors<5>& position) noexcept {
  return 0.5 * element.stiffness * math::SquaredNorm(CalcSlidePlace(element, position).offset);
}

ElementVectors<5> CalcElementForce(const SlidingConstraint& element,
                                   const ElementVectors<5>& position) noexcept {
  const auto [share, offset] = CalcSlidePlace(element, position);
  const std::array<double, 5> weights = CalcOffsetWeights(element, share);
  ElementVectors<5> force;
  for (std::size_t i = 0; i < 5; ++i) force[i] = (-weights[i] * element.stiffness) * offset;
  return force;
}

/// With s held the stiffness is k g g^T I. Within the segment s gives way, which takes off v v^T k / |b - a|^2 (Schur complement of
/// s), v_i = -g_i (b - a), and, of the whole, +c at the first end and -c at the second: the segment turns.
void AddElementStiffness(const SlidingConstraint& element, const ElementVectors<5>& position,
                         StiffnessPart part, ElementStiffness<5>& stiffness) noexcept {
  const auto [share, offset] = CalcSlidePlace(element, position);
  const std::array<double, 5> g = CalcOffsetWeights(element, share);
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = i; j < 5; ++j) AddIdentity(stiffness.At(i, j), element.stiffness * g[i] * g[j]);
  }
  if (part == StiffnessPart::kBound || !IsWithin(share)) return;
  const Vec3 along = position[4] - position[3];
  ElementVectors<5> v;
  for (std::size_t i = 0; i < 5; ++i) v[i] = -g[i] * along;
  if (part == StiffnessPart::kWhole) v[3] += offset, v[4] -= offset;
  const double scale = -element.stiffness / math::SquaredNorm(along);
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t j = i; j < 5; ++j) AddOuterProduct(stiffness.At(i, j), v[i], v[j], scale);
  }
}

bool IsElementUsable(const SlidingConstraint& element) noexcept {
  return std::isfinite(element.stiffness) && element.stiffness >= 0.0 &&
         std::all_of(element.weights.begin(), element.weights.end(),
                     [](double weight) { return std::isfinite(weight) && weight >= 0.0; });
}

void VisitState(base::StateArchive& archive, SlidingConstraint& element) {
  archive.Field("nodes", element.nodes);
  archive.Field("weights", element.weights);
  archive.Field("stiffness", element.stiffness);
}

}  // namespace trocar::tissue
