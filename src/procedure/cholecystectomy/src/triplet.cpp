// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triplet.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "trocar/math/elementary.h"

namespace trocar::cholecystectomy {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(InstrumentKind::kCount)> kInstruments = {
    "grasper", "bipolar", "hook", "scissors", "clipper", "irrigator", "specimen_bag"};
constexpr std::array<std::string_view, static_cast<std::size_t>(Verb::kCount)> kVerbs = {
    "grasp", "retract", "dissect", "coagulate", "clip", "cut", "aspirate", "irrigate", "pack", "null_verb"};
constexpr std::array<std::string_view, static_cast<std::size_t>(Target::kCount)> kTargets = {
    "gallbladder", "cystic_plate",          "cystic_duct", "cystic_artery", "cystic_pedicle", "blood_vessel",
    "fluid",       "abdominal_wall_cavity", "liver",       "adhesion",      "omentum",        "peritoneum",
    "gut",         "specimen_bag",          "null_target"};
constexpr std::array<std::string_view, kPhaseCount> kPhases = {
    "Preparation",          "CalotTriangleDissection", "ClippingCutting",      "GallbladderDissection",
    "GallbladderPackaging", "CleaningCoagulation",     "GallbladderRetraction"};

bool IsDissecting(Verb verb) {
  return verb == Verb::kDissect || verb == Verb::kCut || verb == Verb::kCoagulate;
}

/// The phase that an act speaks for. Holding and retracting speak for none: they go on all the time.
std::optional<Phase> PhaseOf(const Triplet& act, const OperationFacts& facts) noexcept {
  if (facts.is_bag_leaving) return Phase::kGallbladderRetraction;
  if (act.verb == Verb::kPack || act.instrument == InstrumentKind::kSpecimenBag)
    return Phase::kGallbladderPackaging;
  if (act.verb == Verb::kClip) return Phase::kClippingCutting;
  if (act.verb == Verb::kAspirate || act.verb == Verb::kIrrigate) return Phase::kCleaningCoagulation;
  const bool is_pedicle = act.target == Target::kCysticDuct || act.target == Target::kCysticArtery ||
                          act.target == Target::kCysticPedicle;
  if (act.verb == Verb::kCut && is_pedicle) return Phase::kClippingCutting;
  if (!IsDissecting(act.verb)) return std::nullopt;
  const bool is_bed = act.target == Target::kCysticPlate || act.target == Target::kLiver;
  if (act.verb == Verb::kCoagulate && (facts.is_gallbladder_free || act.target == Target::kLiver))
    return Phase::kCleaningCoagulation;
  if (is_bed) return Phase::kGallbladderDissection;
  if (is_pedicle || act.target == Target::kPeritoneum || act.target == Target::kBloodVessel ||
      act.target == Target::kGallbladder)
    return Phase::kCalotTriangleDissection;
  if (act.target == Target::kAdhesion || act.target == Target::kOmentum) return Phase::kPreparation;
  return std::nullopt;
}

}  // namespace

std::string_view NameOf(InstrumentKind instrument) noexcept {
  return kInstruments[static_cast<std::size_t>(instrument)];
}
std::string_view NameOf(Verb verb) noexcept {
  return kVerbs[static_cast<std::size_t>(verb)];
}
std::string_view NameOf(Target target) noexcept {
  return kTargets[static_cast<std::size_t>(target)];
}
std::string_view NameOf(Phase phase) noexcept {
  return kPhases[static_cast<std::size_t>(phase)];
}

std::string NameOf(const Triplet& triplet) {
  std::string name(NameOf(triplet.instrument));
  for (const std::string_view part : {NameOf(triplet.verb), NameOf(triplet.target)}) {
    name += ',';
    name += part;
  }
  return name;
}

void PhaseRecogniser::Update(std::span<const Triplet> acts, const OperationFacts& facts,
                             double seconds) noexcept {
  const double fade = math::Exp(-seconds / kFadeSeconds);
  for (double& evidence : evidence_) evidence *= fade;
  for (const Triplet& act : acts) {
    if (const auto phase = PhaseOf(act, facts)) evidence_[static_cast<std::size_t>(*phase)] += seconds;
  }
  const auto best =
      static_cast<std::size_t>(std::max_element(evidence_.begin(), evidence_.end()) - evidence_.begin());
  const double own = evidence_[static_cast<std::size_t>(current_)];
  // a phase that only fades gives way to one that has begun; a busy one, only to one that has as much
  if (evidence_[best] >= kBeginSeconds && evidence_[best] > own) {
    current_ = static_cast<Phase>(best);
    // what came before is over: going back takes as long as going on did
    for (std::size_t phase = 0; phase < evidence_.size(); ++phase) {
      if (phase != best) evidence_[phase] = 0;
    }
    evidence_[best] = kBeginSeconds;
  }
  // no phase becomes so sure of itself that the next one waits for minutes
  for (double& evidence : evidence_) evidence = std::min(evidence, 2 * kBeginSeconds);
  seconds_[static_cast<std::size_t>(current_)] += seconds;
}

void PhaseRecogniser::VisitState(base::StateArchive& archive) {
  archive.Field("current", current_);
  archive.Field("evidence", evidence_);
  archive.Field("seconds", seconds_);
}

}  // namespace trocar::cholecystectomy
