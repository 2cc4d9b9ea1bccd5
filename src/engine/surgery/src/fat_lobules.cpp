// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/fat_lobules.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/geometry/distance.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"

namespace trocar::surgery {

using math::Vec3;
namespace {

constexpr double kAlong[] = {0.3, 0.7};      // of the lobules on their strand [-]
constexpr double kAlongSpread = 0.15;        // [-]
constexpr double kBeside = 0.0016;           // from the strand, each way [m]
constexpr double kLeast = 0.7, kMost = 1.3;  // times a full lobule's radius
constexpr double kBody = 0.009;              // about a lobule, of the body of fat that it belongs to [m]
constexpr double kRemnant = 0.9;             // share of a body from which on what is left of it is thinner
constexpr double kThinnest = 0.25;  // size of the last lobule of a body, in its size when it was whole

Vec3 PickOffset(math::Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

}  // namespace

FatLobules::FatLobules(std::span<const FatStrand> strands, std::span<const Vec3> rest, double radius) {
  TROCAR_ASSERT(radius > 0);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> end_of(rest.size(), kNone);
  const auto add_end = [&](std::uint32_t node) {
    TROCAR_ASSERT(node < rest.size());
    if (end_of[node] == kNone) {
      end_of[node] = static_cast<std::uint32_t>(ends_.size());
      ends_.emplace_back();
    }
    End& end = ends_[end_of[node]];
    ++end.strands;
    ++end.intact;
    return end_of[node];
  };
  for (const FatStrand& strand : strands) {
    strands_.push_back({strand, {add_end(strand.a), add_end(strand.b)}, true});
    math::Random random(strand.strand);
    for (const double middle : kAlong) {
      Lobule lobule;
      lobule.along = middle + random.Uniform(-kAlongSpread, kAlongSpread);
      lobule.offset = PickOffset(random, kBeside);
      lobule.rest = math::Lerp(rest[strand.a], rest[strand.b], lobule.along) + lobule.offset;
      lobule.full = radius * random.Uniform(kLeast, kMost);
      lobules_.push_back(lobule);
    }
  }
  for (std::size_t i = 0; i < lobules_.size(); ++i) CountNear(i, 1);
  for (Lobule& lobule : lobules_) lobule.near = lobule.left;
  Resize();
}

void FatLobules::Update(std::span<const std::uint8_t> is_intact) noexcept {
  bool has_changed = false;
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    Strand& strand = strands_[i];
    const bool is_whole = strand.of.strand >= is_intact.size() || is_intact[strand.of.strand] != 0;
    if (is_whole == strand.is_intact) continue;
    strand.is_intact = is_whole;
    const int change = is_whole ? 1 : -1;
    for (const std::uint32_t end : strand.ends) ends_[end].intact += change;
    for (std::size_t k = 0; k < kOnStrand; ++k) CountNear(kOnStrand * i + k, change);
    has_changed = true;
  }
  if (has_changed) Resize();
}

/// Counts a lobule in, or out, with all near it.
/// \param change  1 or -1
void FatLobules::CountNear(std::size_t lobule, int change) noexcept {
  const Vec3 rest = lobules_[lobule].rest;
  for (Lobule& other : lobules_)
    other.left += math::SquaredNorm(other.rest - rest) < kBody * kBody ? change : 0;
}

void FatLobules::Resize() noexcept {
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    const Strand& strand = strands_[i];
    const double filling = std::min(ends_[strand.ends[0]].Filling(), ends_[strand.ends[1]].Filling());
    for (std::size_t k = 0; k < kOnStrand; ++k) {
      Lobule& lobule = lobules_[kOnStrand * i + k];
      const double body = static_cast<double>(lobule.left) / static_cast<double>(lobule.near);
      lobule.thin = kThinnest + (1.0 - kThinnest) * std::min(1.0, body / kRemnant);
      lobule.radius = lobule.full * math::Cbrt(filling * lobule.thin * lobule.thin * lobule.thin);
    }
  }
}

Vec3 FatLobules::Centre(std::size_t lobule, std::span<const Vec3> positions) const noexcept {
  const FatStrand& strand = strands_[lobule / kOnStrand].of;
  const Lobule& it = lobules_[lobule];
  return math::Lerp(positions[strand.a], positions[strand.b], it.along) + it.thin * it.offset;
}

bool FatLobules::Hide(std::span<const Vec3> positions, const collision::Segment& sight) const noexcept {
  for (std::size_t i = 0; i < lobules_.size(); ++i) {
    if (!IsThere(i)) continue;
    const Vec3 centre = Centre(i, positions);
    const double along = geometry::FindNearestOnSegment(centre, sight.start, sight.end);
    const double radius = lobules_[i].radius;
    if (math::SquaredNorm(math::Lerp(sight.start, sight.end, along) - centre) < radius * radius) return true;
  }
  return false;
}

}  // namespace trocar::surgery
