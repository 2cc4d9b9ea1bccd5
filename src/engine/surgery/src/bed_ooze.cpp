// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/bed_ooze.h"

#include <algorithm>
#include <cmath>

#include "trocar/math/elementary.h"

namespace trocar::surgery {
namespace {

constexpr double kLeastLeft = 1e-12;  // a place that has less has clotted [m^3]

}  // namespace

BedOoze::BedOoze(std::span<const BedFibre> fibres, double bleeding, const BedOozeSettings& settings)
    : settings_(settings) {
  std::size_t in_bed = 0;
  for (const BedFibre& fibre : fibres) {
    places_.push_back({fibre.strand, fibre.node, true, 0.0});
    in_bed += fibre.is_bed ? 1 : 0;
  }
  // adhesions bleed as much, fibre by fibre
  volume_ = in_bed > 0 ? bleeding * settings_.bed_volume / static_cast<double>(in_bed) : 0.0;
}

double BedOoze::Update(const tissue::TissueState& tissue, const Electrosurgery& heat, std::size_t node_count,
                       double seconds) noexcept {
  const double share = 1.0 - math::Exp(-seconds / settings_.clot_seconds);
  double out = 0;
  for (Place& place : places_) {
    const bool is_intact = tissue.strand_is_intact[place.strand] != 0;
    const bool is_torn = place.was_intact && !is_intact;
    place.was_intact = is_intact;
    if (!is_torn && place.left == 0.0) continue;
    const auto part = static_cast<std::uint32_t>(node_count + place.strand);
    const bool is_sealed =
        heat.InjuryOf(place.node) >= HeatInjury::kBlanched || heat.InjuryOf(part) >= HeatInjury::kBlanched;
    if (is_torn) place.left = volume_;
    if (is_sealed || place.left < kLeastLeft) place.left = 0.0;
    const double drop = share * place.left;
    place.left -= drop;
    out += drop;
  }
  rate_ = out / seconds;
  lost_ += out;
  return out;
}

std::size_t BedOoze::Publish(std::span<const math::Vec3> position,
                             std::span<OozeSnapshot> shown) const noexcept {
  std::size_t count = 0;
  for (const Place& place : places_) {
    const double rate = place.left / settings_.clot_seconds;
    if (!(rate > 0.0) || (count == shown.size() && rate <= shown.back().rate)) continue;
    std::size_t at = count < shown.size() ? count++ : count - 1;
    for (; at > 0 && shown[at - 1].rate < rate; --at) shown[at] = shown[at - 1];
    shown[at] = {position[place.node], rate};
  }
  return count;
}

void BedOoze::VisitState(base::StateArchive& archive) {
  for (Place& place : places_) {
    archive.Field("was_intact", place.was_intact);
    archive.Field("left", place.left);
  }
  archive.Field("rate", rate_);
  archive.Field("lost", lost_);
}

}  // namespace trocar::surgery
