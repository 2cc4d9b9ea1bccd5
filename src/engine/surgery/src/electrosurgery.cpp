// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/electrosurgery.h"

#include <algorithm>
#include <cmath>

#include "trocar/base/assert.h"
#include "trocar/collision/segment_distance.h"

namespace trocar::surgery {
namespace {

using collision::Segment;

}  // namespace

Electrosurgery::Electrosurgery(const tissue::TissueDefinition& definition, std::span<const double> heat_mass,
                               const ElectrosurgerySettings& settings)
    : settings_(settings), node_count_(definition.rest.size()), strands_(definition.strands) {
  TROCAR_ASSERT(heat_mass.size() == node_count_);
  std::vector<HeatNode> nodes;
  for (const double mass : heat_mass) nodes.push_back({std::max(mass, settings_.least_node_mass), 1.0});
  const HeatConstants& constants = settings_.tissue;
  std::vector<HeatLink> links;
  for (const tissue::Spring& spring : definition.springs) {
    const double length = math::Distance(definition.rest[spring.a], definition.rest[spring.b]);
    if (length > 0.0)
      links.push_back(
          {spring.a, spring.b, CalcHeatConductance(constants, 0.5 * length, settings_.layer_depth, length)});
  }
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    const tissue::Strand& strand = strands_[i];
    const double length =
        std::max(settings_.fibre_width, math::Distance(definition.rest[strand.a], definition.rest[strand.b]));
    nodes.push_back({std::max(settings_.least_strand_mass, settings_.fibre_density * settings_.fibre_width *
                                                               settings_.fibre_width * length),
                     0.0});
    const auto part = static_cast<std::uint32_t>(node_count_ + i);
    const double half =
        CalcHeatConductance(constants, settings_.fibre_width, settings_.fibre_width, 0.5 * length);
    links.push_back({strand.a, part, half});
    links.push_back({strand.b, part, half});
  }
  heat_.emplace_back(nodes, links, constants);
  cold_ = heat_.front().MakeState();
  sources_.reserve(kMostSources);
  was_parted_.resize(node_count_);
  Reset();
}

void Electrosurgery::Reset() {
  state_ = cold_;
  std::fill(was_parted_.begin(), was_parted_.end(), std::uint8_t{0});
  sources_.clear();
  parted_strands_ = 0;
  power_ = 0;
  is_cold_ = true;
}

std::size_t Electrosurgery::FindTargets(const Electrode& electrode, std::span<const OrganSurface> organs,
                                        const TubeSet& tubes, const tissue::TissueState& tissue,
                                        std::span<Target> found) const noexcept {
  std::size_t count = 0;
  const auto add = [&](std::uint32_t part, double distance, double share) {
    if (count < found.size()) found[count++] = {part, std::max(0.0, distance), share};
  };
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    if (!tissue.strand_is_intact[i]) continue;
    const Segment strand{tissue.position[strands_[i].a], tissue.position[strands_[i].b]};
    const double distance =
        std::sqrt(collision::FindNearestSegmentSegment(electrode.bare, strand).squared_distance) -
        0.5 * settings_.fibre_width;
    if (distance <= electrode.reach) add(static_cast<std::uint32_t>(node_count_ + i), distance, 1.0);
  }
  for (const OrganSurface& organ : organs) {
    const auto nearest = organ.tree
                             .FindNearestToSegment(organ.Nodes(tissue.position), electrode.bare,
                                                   {.max_distance = electrode.reach})
                             .nearest;
    if (!nearest.Found()) continue;
    for (const std::uint32_t corner : organ.triangles[nearest.triangle])
      add(organ.first_node + corner, std::sqrt(nearest.squared_distance), 1.0 / 3.0);
  }
  const auto tube = tubes.tree.FindNearest(tissue.position, electrode.bare, electrode.reach);
  if (tube.Found()) {
    const collision::TubePiece& piece = tubes.tree.Pieces()[tube.piece];
    add(piece.a, tube.distance, 0.5), add(piece.b, tube.distance, 0.5);
  }
  return count;
}

void Electrosurgery::AddPower(const Electrode& electrode, std::span<const Target> targets) noexcept {
  double sum = 0;
  const auto weight = [this](const Target& target) {
    const double near = settings_.quarter_power / (settings_.quarter_power + target.distance);
    return target.share * near * near;
  };
  for (const Target& target : targets) sum += weight(target);
  for (const Target& target : targets) {
    if (sources_.size() == kMostSources) break;
    sources_.push_back({target.part, electrode.power * weight(target) / sum});
  }
}

std::size_t Electrosurgery::Step(double seconds, tissue::TissueState& tissue,
                                 std::span<std::uint32_t> parted_nodes) noexcept {
  parted_strands_ = 0;
  power_ = 0;
  if (is_cold_ && sources_.empty()) return 0;
  is_cold_ = false;
  for (const auto& source : sources_) power_ += source.power;
  heat_.front().Step(sources_, seconds, state_);
  sources_.clear();
  for (std::uint32_t i = 0; i < strands_.size(); ++i) {
    if (!tissue.strand_is_intact[i]) continue;
    if (InjuryOf(static_cast<std::uint32_t>(node_count_ + i)) < HeatInjury::kParted) continue;
    tissue.strand_is_intact[i] = 0;
    ++parted_strands_;
  }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < node_count_; ++i) {
    if (was_parted_[i] || InjuryOf(i) < HeatInjury::kParted) continue;
    if (count == parted_nodes.size()) break;
    was_parted_[i] = 1;
    parted_nodes[count++] = i;
  }
  return count;
}

void Electrosurgery::CopyNode(std::uint32_t from, std::uint32_t to) noexcept {
  state_.temperature[to] = state_.temperature[from];
  state_.water[to] = state_.water[from];
  state_.damage[to] = state_.damage[from];
  state_.charring[to] = state_.charring[from];
  was_parted_[to] = was_parted_[from];
}

void Electrosurgery::Publish(std::span<float> blanching, std::span<float> charring) const noexcept {
  TROCAR_ASSERT(blanching.size() == charring.size() && blanching.size() <= state_.damage.size());
  for (std::size_t i = 0; i < blanching.size(); ++i) {
    blanching[i] = static_cast<float>(std::min(1.0, state_.damage[i]));
    charring[i] = static_cast<float>(state_.charring[i]);
  }
}

void Electrosurgery::VisitState(base::StateArchive& archive) {
  archive.Field("is_cold", is_cold_);
  // what was never warmed is as it was made
  if (is_cold_) {
    if (archive.IsRestoring()) Reset();
    return;
  }
  archive.Field("heat", state_);
  archive.FixedField("was_parted", was_parted_);
}

}  // namespace trocar::surgery
