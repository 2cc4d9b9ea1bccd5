// SPDX-License-Identifier: Apache-2.0
#include "acts.h"

#include <algorithm>

namespace trocar::dataset {
namespace {

using cholecystectomy::Target;
using cholecystectomy::Triplet;
using cholecystectomy::Verb;
using instrument::ToolKind;
using surgery::FactKind;

constexpr double kRetraction = 0.3;  // N; what holds harder retracts
constexpr double kMoment = 1.0;      // s for which a cut or a clip is seen as one

const instrument::Tool& ToolOf(const scene::Scene& scene, const simulation::Snapshot& now, std::size_t hand) {
  const scene::InstrumentSetup& setup = scene.instruments[hand];
  if (setup.tray.empty()) return setup.tool;
  return setup.tray[std::min<std::size_t>(now.operation.tools[hand], setup.tray.size() - 1)];
}

Target TargetOf(view::LabelClass label) {
  switch (label) {
    case view::LabelClass::kLiver:
      return Target::kLiver;
    case view::LabelClass::kGallbladder:
      return Target::kGallbladder;
    case view::LabelClass::kCysticDuct:
      return Target::kCysticDuct;
    case view::LabelClass::kCysticArtery:
      return Target::kCysticArtery;
    case view::LabelClass::kArtery:
    case view::LabelClass::kBileDuct:
      return Target::kBloodVessel;
    default:
      return Target::kGut;
  }
}

/// What most of the current goes into.
Target FindHeated(std::span<const surgery::Fact> facts, std::size_t hand,
                  const cholecystectomy::TargetTable& targets) {
  std::array<int, static_cast<std::size_t>(Target::kCount)> counts{};
  for (const surgery::Fact& fact : facts) {
    if (fact.kind == FactKind::kCurrentInto && fact.hand == static_cast<int>(hand))
      ++counts[static_cast<std::size_t>(targets.Of(fact))];
  }
  return static_cast<Target>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

}  // namespace

ActWatch::ActWatch(const scene::Scene& scene, std::span<const scene::SurfaceInfo> surfaces,
                   std::span<const scene::StrandInfo> strands)
    : scene_(&scene) {
  for (const scene::SurfaceInfo& surface : surfaces)
    targets_.surfaces.push_back(TargetOf(view::FindLabelClass(surface, scene.HasPatient())));
  for (const scene::StrandInfo& strand : strands)
    targets_.strands.push_back(cholecystectomy::TargetOf(strand.kind));
}

Triplet ActWatch::ActOf(const simulation::Snapshot& now, std::size_t hand) {
  const simulation::InstrumentSnapshot& tool = now.instruments[hand];
  const ToolKind kind = ToolOf(*scene_, now, hand).kind;
  const auto facts = std::span(now.facts).first(now.fact_count);
  Triplet act{cholecystectomy::InstrumentOf(kind), Verb::kNullVerb, Target::kNullTarget};
  const surgery::Fact* current = nullptr;
  for (const surgery::Fact& fact : facts) {
    if (fact.hand != static_cast<int>(hand)) continue;
    if (fact.kind == FactKind::kCurrentInto) current = &fact;
    const auto triplet = cholecystectomy::TripletOf(fact, targets_);
    const bool is_moment =
        fact.kind != FactKind::kCurrentInto && triplet &&
        (triplet->verb == Verb::kCut || triplet->verb == Verb::kClip || triplet->verb == Verb::kDissect);
    if (is_moment) moments_[hand] = {{act.instrument, triplet->verb, triplet->target}, now.time + kMoment};
  }
  const Moment& moment = moments_[hand];
  if (current != nullptr) {
    act.verb = current->is_coagulating ? Verb::kCoagulate : Verb::kDissect;
    act.target = FindHeated(facts, hand, targets_);
  } else if (now.time < moment.until && moment.triplet.instrument == act.instrument) {
    act = moment.triplet;
  } else if (now.operation.is_aspirating[hand]) {
    act = {act.instrument, Verb::kAspirate, Target::kFluid};
  } else if (now.operation.is_rinsing[hand]) {
    const bool is_liver = targets_.OfSurface(tool.organ) == Target::kLiver;
    act = {act.instrument, Verb::kIrrigate, is_liver ? Target::kLiver : Target::kAbdominalWallCavity};
  } else if (tool.is_grasping && tool.organ >= 0) {
    act.target = targets_.OfSurface(tool.organ);
    const bool is_packed = act.target == Target::kGallbladder &&
                           std::any_of(facts.begin(), facts.end(),
                                       [](const auto& fact) { return fact.kind == FactKind::kBagOpen; });
    const bool is_pulled = math::Norm(tool.force) > kRetraction;
    act.verb = is_packed ? Verb::kPack : is_pulled ? Verb::kRetract : Verb::kGrasp;
  }
  return act;
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
