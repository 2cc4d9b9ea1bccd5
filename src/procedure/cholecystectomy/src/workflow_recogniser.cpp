// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/workflow_recogniser.h"

#include <algorithm>
#include <optional>

#include "trocar/math/elementary.h"

namespace trocar::cholecystectomy {
namespace {

bool IsPedicle(Target target) {
  return target == Target::kCysticDuct || target == Target::kCysticArtery || target == Target::kCysticPedicle;
}

/// The phase that parting or coagulating a target speaks for.
std::optional<Phase> PhaseOfDissection(const Triplet& act, const WorkflowFacts& facts) noexcept {
  if (facts.is_gallbladder_free) {
    if (act.verb == Verb::kCoagulate) return Phase::kCleaningCoagulation;
    return std::nullopt;
  }
  switch (act.target) {
    case Target::kCysticPlate:
    case Target::kGallbladder:
      if (facts.has_divided || facts.is_upper_bed) return Phase::kGallbladderDissection;
      return Phase::kCalotTriangleDissection;
    case Target::kLiver:  // beside the bed; before, a touch that nobody wants
      return facts.has_divided ? std::optional(Phase::kGallbladderDissection) : std::nullopt;
    case Target::kCysticDuct:
    case Target::kCysticArtery:
    case Target::kCysticPedicle:
    case Target::kPeritoneum:
    case Target::kBloodVessel:
      return facts.has_divided ? std::nullopt : std::optional(Phase::kCalotTriangleDissection);
    default:  // adhesions and omentum belong to the preparation, and are freed in later phases too
      return std::nullopt;
  }
}

/// The phase that a tool speaks for by being there.
std::optional<Phase> PhaseOfPresence(InstrumentKind instrument, const WorkflowFacts& facts) noexcept {
  if (facts.is_gallbladder_free) return std::nullopt;
  if (instrument == InstrumentKind::kClipper && facts.structures_entering > 0) return Phase::kClippingCutting;
  const bool dissects = instrument == InstrumentKind::kHook || instrument == InstrumentKind::kBipolar;
  if (dissects && facts.has_divided && facts.structures_entering == 0) return Phase::kGallbladderDissection;
  return std::nullopt;
}

/// The phase that an act speaks for. Holding and retracting speak for none: they go on all the time.
std::optional<Phase> PhaseOf(const Triplet& act, const WorkflowFacts& facts) noexcept {
  switch (act.verb) {
    case Verb::kGrasp:
    case Verb::kRetract:
      return std::nullopt;
    case Verb::kClip:
      return Phase::kClippingCutting;
    case Verb::kPack:
      return facts.is_gallbladder_free ? std::optional(Phase::kGallbladderPackaging) : std::nullopt;
    case Verb::kAspirate:
    case Verb::kIrrigate:
      return facts.is_gallbladder_free ? std::optional(Phase::kCleaningCoagulation) : std::nullopt;
    case Verb::kNullVerb:
      return PhaseOfPresence(act.instrument, facts);
    case Verb::kCut:
      // of a fibre with scissors is dissection, of what the fibres hid is not
      if (IsPedicle(act.target) && act.target != Target::kCysticPedicle) return Phase::kClippingCutting;
      return PhaseOfDissection(act, facts);
    default:
      return PhaseOfDissection(act, facts);
  }
}

}  // namespace

void WorkflowRecogniser::Update(std::span<const SeenAct> acts, const WorkflowFacts& facts,
                                double seconds) noexcept {
  const double fade = math::Exp(-seconds / kFadeSeconds);
  for (double& evidence : evidence_) evidence *= fade;
  std::array<double, kPhaseCount> spoken{};  // two hands at one work are one work
  for (const SeenAct& act : acts) {
    const auto phase = PhaseOf(act.triplet, facts);
    if (!phase) continue;
    double& most = spoken[static_cast<std::size_t>(*phase)];
    most = std::max(most, act.seconds);
  }
  // a closed bag that is held meanwhile does not end the cleaning
  if (current_ == Phase::kCleaningCoagulation && facts.is_gallbladder_in_bag)
    spoken[static_cast<std::size_t>(Phase::kGallbladderPackaging)] = 0.0;
  if (facts.is_bag_leaving && spoken[static_cast<std::size_t>(Phase::kCleaningCoagulation)] == 0.0) {
    // who cleans meanwhile does not stop with the last drop
    const bool has_packed = current_ != Phase::kCleaningCoagulation;
    spoken[static_cast<std::size_t>(Phase::kGallbladderRetraction)] =
        has_packed ? 3 * kBeginSeconds : seconds;
  }
  for (std::size_t phase = 0; phase < spoken.size(); ++phase) evidence_[phase] += spoken[phase];
  const auto best =
      static_cast<std::size_t>(std::max_element(evidence_.begin(), evidence_.end()) - evidence_.begin());
  // a phase that only fades gives way to one that has begun; a busy one, only to one that has more
  if (evidence_[best] >= kBeginSeconds && evidence_[best] > evidence_[static_cast<std::size_t>(current_)]) {
    current_ = static_cast<Phase>(best);
    // what came before is over: going back takes as long as going on did
    evidence_.fill(0.0);
    evidence_[best] = kBeginSeconds;
  }
  // no phase becomes so sure of itself that the next one waits for minutes
  for (double& evidence : evidence_) evidence = std::min(evidence, kBeginSeconds);
  seconds_[static_cast<std::size_t>(current_)] += seconds;
}

void WorkflowRecogniser::VisitState(base::StateArchive& archive) {
  archive.Field("current", current_);
  archive.Field("evidence", evidence_);
  archive.Field("seconds", seconds_);
}

}  // namespace trocar::cholecystectomy
