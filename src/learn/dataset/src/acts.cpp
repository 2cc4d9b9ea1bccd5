// SPDX-License-Identifier: Apache-2.0
#include "acts.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace trocar::dataset {
namespace {

using cholecystectomy::Target;
using cholecystectomy::Triplet;
using cholecystectomy::Verb;
using instrument::ToolKind;
using surgery::FactKind;

/// An organ that is simulated and of which nothing more is known is none of a vessel's.
Target TargetOf(const scene::SurfaceInfo& surface) {
  if (!surface.radii.empty()) return cholecystectomy::TargetOf(surface.tube);
  return cholecystectomy::TargetOf(surface.organ).value_or(Target::kGut);
}

/// Act of the current of a hand, of what most of it flows into; nothing where none flows.
std::optional<Triplet> FindCurrent(std::span<const surgery::Fact> facts, std::size_t hand,
                                   const cholecystectomy::TargetTable& targets) {
  std::vector<std::pair<Triplet, int>> counts;
  for (const surgery::Fact& fact : facts) {
    if (fact.kind != FactKind::kCurrentInto || fact.hand != static_cast<int>(hand)) continue;
    const Triplet act = *cholecystectomy::TripletOf(fact, targets);
    const auto known =
        std::find_if(counts.begin(), counts.end(), [&](const auto& one) { return one.first == act; });
    if (known != counts.end()) {
      ++known->second;
    } else {
      counts.emplace_back(act, 1);
    }
  }
  const auto most = std::max_element(counts.begin(), counts.end(),
                                     [](const auto& x, const auto& y) { return x.second < y.second; });
  return most == counts.end() ? std::nullopt : std::optional(most->first);
}

}  // namespace

const instrument::Tool& ToolOf(const scene::Scene& scene, const simulation::Snapshot& now, std::size_t hand) {
  const scene::InstrumentSetup& setup = scene.instruments[hand];
  if (setup.tray.empty()) return setup.tool;
  return setup.tray[std::min<std::size_t>(now.operation.tools[hand], setup.tray.size() - 1)];
}

ActWatch::ActWatch(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces,
                   std::span<const scene::StrandInfo> strands)
    : scene_(&scene) {
  for (const scene::SurfaceInfo& surface : surfaces) targets_.surfaces.push_back(TargetOf(surface));
  for (const scene::StrandInfo& strand : strands)
    targets_.strands.push_back(cholecystectomy::TargetOf(strand.kind));
}

Triplet ActWatch::ActOf(const simulation::Snapshot& now, std::size_t hand) {
  const simulation::InstrumentSnapshot& tool = now.instruments[hand];
  const ToolKind kind = ToolOf(*scene_, now, hand).kind;
  const auto facts = std::span(now.facts).first(now.fact_count);
  std::optional<Triplet> fluid;
  bool is_bag_open = false;
  for (surgery::Fact fact : facts) {
    is_bag_open = is_bag_open || fact.kind == FactKind::kBagOpen;
    if (fact.kind == FactKind::kRinse) fact.surface = tool.organ;  // on which the jet lies
    const auto act = cholecystectomy::TripletOf(fact, targets_);
    if (!act || fact.hand != static_cast<int>(hand)) continue;
    if (cholecystectomy::IsMoment(fact.kind)) moments_[hand] = {*act, now.time + cholecystectomy::kMoment};
    if (act->verb == Verb::kAspirate || act->verb == Verb::kIrrigate) fluid = *act;
  }
  const Moment& moment = moments_[hand];
  const Triplet idle{cholecystectomy::InstrumentOf(kind), Verb::kNullVerb, Target::kNullTarget};
  if (const auto current = FindCurrent(facts, hand, targets_)) return *current;
  if (now.time < moment.until && moment.triplet.instrument == idle.instrument) return moment.triplet;
  if (fluid) return *fluid;
  if (!tool.is_grasping || tool.organ < 0) return idle;
  return cholecystectomy::TripletOfHold(kind, targets_.OfSurface(tool.organ), math::Norm(tool.force),
                                        is_bag_open);
}

void ActWatch::Look(const simulation::Snapshot& now) {
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand) {
    const ToolKind kind = ToolOf(*scene_, now, hand).kind;
    acts_[hand] = {ActOf(now, hand), hand, view::FindLabelClass(kind)};
    is_instrument_[hand] = kind != ToolKind::kBag;
  }
}

std::vector<Act> ActWatch::Acts() const {
  std::vector<Act> acts;
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand)
    if (is_instrument_[hand]) acts.push_back(acts_[hand]);
  return acts;
}

}  // namespace trocar::dataset
