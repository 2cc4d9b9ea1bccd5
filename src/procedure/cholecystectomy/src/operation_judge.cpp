// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/operation_judge.h"

#include <algorithm>
#include <utility>

#include "trocar/math/state_fields.h"

namespace trocar::cholecystectomy {
namespace {

constexpr int kClipsThatStay = 2;  // on the patient's side of a cut: the rule that is taught

}  // namespace

OperationJudge::OperationJudge(DissectionMonitor dissection, bool has_critical_view,
                               const JudgementSettings& settings)
    : has_view_(has_critical_view), settings_(settings), dissection_(std::move(dissection)) {}

void OperationJudge::JudgeAct(const EmittedAct& act, double time) noexcept {
  const auto report = [&](OperationError error) { errors_.Add({error, time, act.position, act.hand}); };
  switch (act.kind) {
    case EmittedAct::Kind::kError:
      report(act.error);
      break;
    case EmittedAct::Kind::kClip:
      if (act.clip.kind == surgery::ClipResult::Kind::kLost) {
        report(OperationError::kClipDropped);
        break;
      }
      if (!act.vessel.may_be_divided) report(OperationError::kWrongStructureClipped);
      if (has_view_ && !was_achieved_) report(OperationError::kClipBeforeCriticalView);
      if (act.clip.is_crossed) report(OperationError::kClipCrossed);
      if (act.clip.kind == surgery::ClipResult::Kind::kPartial) report(OperationError::kClipPartial);
      break;
    case EmittedAct::Kind::kCut:
      if (!act.vessel.may_be_divided) {
        report(OperationError::kWrongStructureCut);
        break;
      }
      // a second cut of what is divided already closes nothing and opens nothing
      if (act.vessel.cuts > 1) break;
      if (act.vessel.staying_clips == 0) report(OperationError::kUnclippedCut);
      if (act.vessel.staying_clips > 0 && act.vessel.staying_clips < kClipsThatStay)
        report(OperationError::kTooFewClips);
      break;
    case EmittedAct::Kind::kHole:
      if (!act.vessel.may_be_divided) {
        report(OperationError::kWrongStructureBurnt);
      } else if (act.vessel.staying_clips == 0) {
        report(OperationError::kUnclippedCut);
      }
      break;
  }
}

void OperationJudge::JudgeHand(int hand, const OperationObservation& now) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  const ObservedHand& seen = now.hands[h];
  const auto report = [&](OperationError error) { errors_.Add({error, now.time, seen.p_world_tip, hand}); };
  if (seen.is_retracting && seen.is_holding_liver) report(OperationError::kLiverGrasped);
  if (seen.change == surgery::GraspChange::kSlipped || seen.change == surgery::GraspChange::kDamaged)
    report(OperationError::kExcessForce);
  HandState& state = hands_[h];
  if (now.acts.WasExchanged(hand)) state = {true, 0.0};
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

void OperationJudge::JudgePhase(const OperationObservation& now) noexcept {
  // what a hand holds it retracts, whatever else it has done
  EmittedActs acts = now.acts;
  for (std::size_t hand = 0; hand < now.hands.size(); ++hand) {
    if (now.hands[hand].is_retracting)
      acts.Add({InstrumentKind::kGrasper, Verb::kRetract, now.hands[hand].held}, static_cast<int>(hand));
  }
  std::array<Triplet, EmittedActs::kMostHandActs> triplets;
  std::size_t count = 0;
  for (const HandAct& act : acts.HandActs()) triplets[count++] = act.triplet;
  phases_.Update(std::span(triplets).first(count), now.facts, now.seconds);
}

void OperationJudge::Update(const OperationObservation& now) noexcept {
  errors_before_ = errors_.Entries().size();
  for (const EmittedAct& act : now.acts.Acts()) JudgeAct(act, now.time);
  for (int hand = 0; hand < instrument::kHandCount; ++hand) JudgeHand(hand, now);

  dissection_.Update(now.tissue, now.vessels, now.organs, now.camera);
  view_.Update(dissection_.Facts(), now.seconds);
  was_achieved_ = was_achieved_ || view_.Score().IsAchieved();
  JudgePhase(now);
  if (now.blood_lost > settings_.much_blood && errors_.Count(OperationError::kBleeding) == 0)
    errors_.Add({OperationError::kBleeding, now.time, now.p_pool, -1});
  const bool is_completed = now.facts.is_bag_leaving;
  if (is_completed && !was_completed_ && now.spilled_stones > 0)
    errors_.Add({OperationError::kStonesLeft, now.time, now.p_pool, -1});
  was_completed_ = is_completed;
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
  if (archive.IsRestoring()) errors_before_ = errors_.Entries().size();
}

}  // namespace trocar::cholecystectomy
