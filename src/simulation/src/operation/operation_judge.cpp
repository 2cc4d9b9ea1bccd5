// SPDX-License-Identifier: Apache-2.0
#include "operation/operation_judge.h"

#include <algorithm>

#include "trocar/math/state_fields.h"

namespace trocar::simulation {
namespace {

using training::OperationError;

constexpr double kMuchBlood = 50e-6;  // [m^3], domain facts, section 1.4
constexpr int kClipsThatStay = 2;
constexpr double kTipIn = 0.08;  // a tool this deep has been pushed in [m]
constexpr double kBlindSeconds = 1.5;

}  // namespace

OperationJudge::OperationJudge(const Scene& scene, const PatientTissue& tissue, const Operation& operation)
    : has_view_(operation.Gallbladder() >= 0),
      watch_(scene.patient, tissue.surfaces, operation.DissectedStrands(), tissue.definition.rest) {}

void OperationJudge::Report(OperationError error, const Vec3& p, int hand, double time) noexcept {
  errors_.Add({error, time, p, hand});
}

void OperationJudge::JudgeAct(const EmittedAct& act, double time) noexcept {
  const auto report = [&](OperationError error) { Report(error, act.position, act.hand, time); };
  switch (act.kind) {
    case EmittedAct::Kind::kError:
      report(act.error);
      break;
    case EmittedAct::Kind::kClip:
      if (act.clip.kind == ClipResult::Kind::kLost) {
        report(OperationError::kClipDropped);
        break;
      }
      if (!act.vessel.may_be_divided) report(OperationError::kWrongStructureClipped);
      if (has_view_ && !was_achieved_) report(OperationError::kClipBeforeCriticalView);
      if (act.clip.is_crossed) report(OperationError::kClipCrossed);
      if (act.clip.kind == ClipResult::Kind::kPartial) report(OperationError::kClipPartial);
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

void OperationJudge::JudgeHand(int hand, const Operation& operation, const HandsNow& hands,
                               const Camera& camera, EmittedActs& acts) noexcept {
  const auto h = static_cast<std::size_t>(hand);
  const Vec3& tip = hands.X_proxy[h].translation;
  const surgery::Grasp& grasp = (*hands.grasps)[h];
  if (grasp.IsHolding() && operation.Tool(hand).kind != instrument::ToolKind::kBag) {
    acts.Add({training::InstrumentKind::kGrasper, training::Verb::kRetract,
              operation.TargetOfSurface(grasp.surface)},
             hand);
    if (grasp.surface == operation.Liver()) Report(OperationError::kLiverGrasped, tip, hand, hands.time);
  }
  if (hands.changes[h] == surgery::GraspChange::kSlipped ||
      hands.changes[h] == surgery::GraspChange::kDamaged)
    Report(OperationError::kExcessForce, tip, hand, hands.time);
  HandState& state = hands_[h];
  if (acts.WasExchanged(hand)) state = {true, 0.0};
  if (!state.is_inserting) return;
  if (IsInView(camera.X_world_camera, camera.field_of_view, tip)) {
    state.is_inserting = false;
  } else if (hands.joints[h].depth > kTipIn) {
    state.blind_seconds += hands.seconds;
    if (state.blind_seconds > kBlindSeconds) {
      Report(OperationError::kBlindInsertion, tip, hand, hands.time);
      state.is_inserting = false;
    }
  }
}

void OperationJudge::Update(const Operation& operation, const HandsNow& hands, const TissueNow& tissue,
                            const Camera& camera) noexcept {
  told_errors_ = errors_.Entries().size();
  EmittedActs acts = operation.Acts();
  for (const EmittedAct& act : acts.Acts()) JudgeAct(act, hands.time);
  for (int hand = 0; hand < kHandCount; ++hand) JudgeHand(hand, operation, hands, camera, acts);

  watch_.Update(*tissue.state, operation.Vessels(), tissue.organs, camera);
  view_.Update(watch_.Facts(), hands.seconds);
  was_achieved_ = was_achieved_ || view_.Score().IsAchieved();
  std::array<training::Triplet, 16> triplets;
  std::size_t count = 0;
  for (const HandAct& act : acts.HandActs()) triplets[count++] = act.triplet;
  phases_.Update(std::span(triplets).first(count),
                 {operation.IsGallbladderFree(), operation.IsInBag(), operation.IsCompleted()},
                 hands.seconds);
  const auto& blood = operation.Fluids().fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)];
  if (blood.left > kMuchBlood && errors_.Count(OperationError::kBleeding) == 0)
    Report(OperationError::kBleeding, operation.Pool(), -1, hands.time);
  if (operation.IsCompleted() && !was_completed_ && operation.Stones().Count().spilled > 0)
    Report(OperationError::kStonesLeft, operation.Pool(), -1, hands.time);
  was_completed_ = operation.IsCompleted();
}

void OperationJudge::Publish(OperationSnapshot& snapshot) const noexcept {
  snapshot.facts.cleared_share = watch_.Facts().cleared_share;
  snapshot.facts.detached_share = watch_.Facts().detached_share;
  snapshot.facts.structures_entering = watch_.Facts().structures_entering;
  snapshot.critical_view = view_.Score();
  snapshot.phase = phases_.Current();
  snapshot.errors = errors_.Count();
  snapshot.critical_errors = errors_.Count(training::Severity::kCritical);
}

void OperationJudge::AddTo(OperationResult& result) const {
  result.errors = errors_;
  result.facts = watch_.Facts();
  result.critical_view = view_.Score();
  result.was_critical_view_achieved = was_achieved_;
  result.phase = phases_.Current();
}

void OperationJudge::VisitState(core::StateArchive& archive) {
  archive.Field("watch", watch_);
  archive.Field("errors", errors_);
  archive.Field("view", view_);
  archive.Field("phases", phases_);
  for (HandState& hand : hands_) {
    archive.Field("is_inserting", hand.is_inserting);
    archive.Field("blind_seconds", hand.blind_seconds);
  }
  archive.Field("was_achieved", was_achieved_);
  archive.Field("was_completed", was_completed_);
  if (archive.IsRestoring()) told_errors_ = errors_.Entries().size();
}

}  // namespace trocar::simulation
