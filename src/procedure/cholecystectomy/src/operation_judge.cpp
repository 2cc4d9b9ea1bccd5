// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_judge.h"

#include <algorithm>
#include <any>
#include <cstdint>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/cholecystectomy/cholecystectomy.h"
#include "trocar/math/state_fields.h"

namespace trocar::cholecystectomy {

using surgery::FactKind;

namespace {

constexpr double kMiddleOfBed = 0.5;  // from the infundibulum; the critical view asks for a third [-]
constexpr int kClipsThatStay = 2;     // on the patient's side of a cut: the rule that is taught

}  // namespace

OperationJudge::OperationJudge(JudgedAnatomy anatomy, DissectionMonitor dissection,
                               const surgery::JudgementSettings& settings)
    : anatomy_(std::move(anatomy)),
      settings_(settings),
      dissection_(std::move(dissection)),
      errors_(OperationErrors()) {
  is_upper_bed_.resize(anatomy_.targets.strands.size());
  for (const DissectedAnatomy::BedFibre& fibre : dissection_.Bed()) {
    if (fibre.strand < is_upper_bed_.size()) is_upper_bed_[fibre.strand] = fibre.along > kMiddleOfBed ? 1 : 0;
  }
}

void OperationJudge::Report(OperationError error, const surgery::Fact& fact, double time) noexcept {
  errors_.Add({error, time, fact.position, fact.hand});
}

void OperationJudge::JudgeFact(const surgery::Fact& fact, const surgery::OperationObservation& now) noexcept {
  const Target target = anatomy_.targets.Of(fact);
  switch (fact.kind) {
    case FactKind::kOrganCut:
      if (!anatomy_.may_cut_organs && target != Target::kGallbladder)
        Report(OperationError::kStructureTorn, fact, now.time);
      break;
    case FactKind::kOrganOpened:
      Report(OperationError::kGallbladderPerforated, fact, now.time);
      break;
    case FactKind::kOrganBurnt:
      if (target == Target::kGallbladder) Report(OperationError::kGallbladderPerforated, fact, now.time);
      if (target == Target::kLiver) Report(OperationError::kLiverBurnt, fact, now.time);
      break;
    case FactKind::kClipLost:
      Report(OperationError::kClipDropped, fact, now.time);
      break;
    case FactKind::kClipSlipped:
      Report(OperationError::kClipSlipped, fact, now.time);
      break;
    case FactKind::kClipClosed:
    case FactKind::kTubeCut:
    case FactKind::kTubeBurnt:
    case FactKind::kTubeTornOff:
      JudgeTube(fact, now);
      break;
    case FactKind::kCurrentOn:
      JudgeCurrent(fact, now);
      break;
    default:
      break;
  }
}

/// What was done to a duct or artery.
void OperationJudge::JudgeTube(const surgery::Fact& fact, const surgery::OperationObservation& now) noexcept {
  const auto tube = static_cast<std::uint32_t>(static_cast<std::size_t>(fact.surface) - anatomy_.organ_count);
  const surgery::TubePlace place{tube, fact.along};
  const VesselJudgement vessel = JudgePlace(anatomy_.biliary, now.vessels, place);
  switch (fact.kind) {
    case FactKind::kClipClosed:
      if (!vessel.may_be_divided) Report(OperationError::kWrongStructureClipped, fact, now.time);
      if (anatomy_.has_critical_view && !was_achieved_)
        Report(OperationError::kClipBeforeCriticalView, fact, now.time);
      if (fact.is_crossed) Report(OperationError::kClipCrossed, fact, now.time);
      if (fact.is_partial) Report(OperationError::kClipPartial, fact, now.time);
      break;
    case FactKind::kTubeCut:
      if (!vessel.may_be_divided) {
        Report(OperationError::kWrongStructureCut, fact, now.time);
        break;
      }
      // a second cut of what is divided already closes nothing and opens nothing
      if (fact.amount > 1.0) break;
      if (vessel.staying_clips == 0) Report(OperationError::kUnclippedCut, fact, now.time);
      if (vessel.staying_clips > 0 && vessel.staying_clips < kClipsThatStay)
        Report(OperationError::kTooFewClips, fact, now.time);
      break;
    default:
      // of what is divided already only the gallbladder's side came off
      if (fact.kind == FactKind::kTubeTornOff && fact.amount > 0.0) break;
      if (!vessel.may_be_divided) {
        Report(OperationError::kWrongStructureBurnt, fact, now.time);
      } else if (vessel.staying_clips == 0) {
        Report(OperationError::kUnclippedCut, fact, now.time);
      }
      break;
  }
}

/// An electrode's pedal is down.
void OperationJudge::JudgeCurrent(const surgery::Fact& fact,
                                  const surgery::OperationObservation& now) noexcept {
  if (!instrument::IsInView(now.camera.X_world_camera, now.camera.field_of_view, fact.position))
    Report(OperationError::kEnergyOutOfView, fact, now.time);
  if (fact.amount > settings_.idle_seconds) Report(OperationError::kEnergyWithoutContact, fact, now.time);
  if (fact.amount > 0.0) return;  // nothing is touched
  const bool is_near =
      std::any_of(anatomy_.main_ducts.begin(), anatomy_.main_ducts.end(), [&](std::uint32_t node) {
        return math::Distance(now.tissue.position[node], fact.position) < settings_.near_duct;
      });
  if (is_near) Report(OperationError::kEnergyNearDuct, fact, now.time);
}

void OperationJudge::JudgeHand(int hand, const surgery::OperationObservation& now) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  const surgery::HandObservation& seen = now.hands[h];
  const auto report = [&](OperationError error) { errors_.Add({error, now.time, seen.p_world_tip, hand}); };
  if (seen.is_holding && anatomy_.targets.OfSurface(seen.held_surface) == Target::kLiver)
    report(OperationError::kLiverGrasped);
  if (seen.change == surgery::GraspChange::kSlipped || seen.change == surgery::GraspChange::kDamaged)
    report(OperationError::kExcessForce);
  HandState& state = hands_[h];
  const bool was_exchanged = std::any_of(now.facts.begin(), now.facts.end(), [&](const surgery::Fact& fact) {
    return fact.kind == FactKind::kToolExchanged && fact.hand == hand;
  });
  if (was_exchanged) state = {true, 0.0};
  if (!state.is_inserting) return;
  if (instrument::IsInView(now.camera.X_world_camera, now.camera.field_of_view, seen.p_world_tip)) {
    state.is_inserting = false;
  } else if (seen.depth > settings_.tip_in) {
    state.blind_seconds += now.seconds;
    if (state.blind_seconds > settings_.blind_seconds) {
      report(OperationError::kBlindInsertion);
      state.is_inserting = false;
    }
  }
}

void OperationJudge::JudgePhase(const surgery::OperationObservation& now) noexcept {
  HandActs acts;
  const auto& [is_free, is_in_bag, is_leaving] = now.retrieval;
  const auto entering = static_cast<std::size_t>(dissection_.Facts().structures_entering);
  WorkflowFacts facts{is_free, is_in_bag, is_leaving};
  facts.structures_entering = dissection_.Facts().structures_entering;
  facts.has_divided = !now.vessels.Acts().clips.empty() || entering < dissection_.EnteringAtStart();
  bool is_bag_open = false;
  for (const surgery::Fact& fact : now.facts) {
    const auto triplet = TripletOf(fact, anatomy_.targets);
    if (!triplet) continue;
    acts.Add(*triplet, fact.hand, IsMoment(fact.kind) ? kMoment : now.seconds);
    is_bag_open = is_bag_open || fact.kind == FactKind::kBagOpen;
    const auto strand = static_cast<std::size_t>(fact.strand);
    facts.is_upper_bed = facts.is_upper_bed ||
                         (fact.strand >= 0 && strand < is_upper_bed_.size() && is_upper_bed_[strand] != 0);
  }
  for (std::size_t hand = 0; hand < now.hands.size(); ++hand) {
    const surgery::HandObservation& seen = now.hands[hand];
    const auto h = static_cast<int>(hand);
    if (seen.is_holding) {
      acts.Add(TripletOfHold(seen.tool, anatomy_.targets.OfSurface(seen.held_surface), 0.0, is_bag_open), h,
               now.seconds);
    } else if (seen.depth > settings_.tip_in) {
      acts.Add({InstrumentOf(seen.tool), Verb::kNullVerb, Target::kNullTarget}, h, now.seconds);
    }
  }
  phases_.Update(acts.Acts(), facts, now.seconds);
}

void OperationJudge::SeeTools(const surgery::OperationObservation& now) noexcept {
  errors_before_ = errors_.Entries().size();
  for (const surgery::Fact& fact : now.facts) JudgeFact(fact, now);
  facts_seen_ = now.facts.size();
}

void OperationJudge::Update(const surgery::OperationObservation& now) noexcept {
  if (facts_seen_ == 0) errors_before_ = errors_.Entries().size();
  for (const surgery::Fact& fact : now.facts.subspan(facts_seen_)) JudgeFact(fact, now);
  facts_seen_ = 0;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) JudgeHand(hand, now);

  dissection_.Update(now.tissue, now.vessels, now.organs, now.camera);
  view_.Update(dissection_.Facts(), now.seconds);
  was_achieved_ = was_achieved_ || view_.Score().IsAchieved();
  JudgePhase(now);
  if (now.blood_lost > settings_.much_blood && errors_.Count(OperationError::kBleeding) == 0)
    errors_.Add({OperationError::kBleeding, now.time, now.p_pool, -1});
  const bool is_completed = now.retrieval.is_leaving;
  if (is_completed && !was_completed_ && now.spilled_stones > 0)
    errors_.Add({OperationError::kStonesLeft, now.time, now.p_pool, -1});
  was_completed_ = is_completed;
}

void OperationJudge::Publish(scene::ProcedureSnapshot& snapshot) const noexcept {
  const DissectionFacts& facts = Facts();
  const CriticalViewScore& score = View();
  snapshot.phase = static_cast<std::uint8_t>(CurrentPhase());
  TROCAR_ASSERT(snapshot.measures.size() == kMeasureCount && snapshot.view.sights.size() == kSightCount &&
                snapshot.view.criteria.size() == score.criteria.size());
  snapshot.measures[kClearedShare] = facts.cleared_share;
  snapshot.measures[kDetachedShare] = facts.detached_share;
  snapshot.measures[kStructuresEntering] = facts.structures_entering;
  for (std::size_t i = 0; i < score.criteria.size(); ++i)
    snapshot.view.criteria[i] = static_cast<std::uint8_t>(score.criteria[i]);
  snapshot.view.sights[kFromFront] = score.is_seen_from_front ? 1 : 0;
  snapshot.view.sights[kFromBehind] = score.is_seen_from_behind ? 1 : 0;
}

scene::ProcedureResult OperationJudge::CalcResult(const surgery::Vessels& vessels,
                                                  const surgery::StoneCount& stones) const {
  scene::ProcedureResult result;
  result.errors = errors_;
  scene::SizeSnapshot(Cholecystectomy(), result.now);
  Publish(result.now);
  result.was_view_achieved = was_achieved_;
  result.missing = ExplainCriticalView(Facts(), View());
  OperationDetail detail{Facts(), View(), {}};
  surgery::FlowNetwork network = vessels.Map().network;
  detail.injuries = JudgeInjuries(anatomy_.biliary, vessels.Acts(), network);
  detail.injuries.spilled_stones = stones.spilled;
  result.findings = {
      {"strasberg", StrasbergName(detail.injuries.strasberg), detail.injuries.strasberg >= Strasberg::kB},
      {"right_liver_without_blood", detail.injuries.is_right_liver_without_blood,
       detail.injuries.is_right_liver_without_blood}};
  result.detail = std::move(detail);
  return result;
}

const OperationDetail* FindDetail(const scene::ProcedureResult& result) noexcept {
  return std::any_cast<OperationDetail>(&result.detail);
}

void OperationJudge::VisitState(base::StateArchive& archive) {
  archive.Field("dissection", dissection_);
  archive.Field("errors", errors_);
  archive.Field("view", view_);
  archive.Field("phases", phases_);
  for (HandState& hand : hands_) {
    archive.Field("is_inserting", hand.is_inserting);
    archive.Field("blind_seconds", hand.blind_seconds);
  }
  archive.Field("was_achieved", was_achieved_);
  archive.Field("was_completed", was_completed_);
  if (!archive.IsRestoring()) return;
  errors_before_ = errors_.Entries().size();
  facts_seen_ = 0;
}

}  // namespace trocar::cholecystectomy
