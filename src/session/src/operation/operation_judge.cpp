// SPDX-License-Identifier: Apache-2.0
#include "operation_judge.h"

#include <algorithm>

namespace trocar::session {
namespace {

using training::MayBeDivided;
using training::OperationError;
using training::VesselRole;

constexpr double kMuchBlood = 50e-6;  // [m^3], domain facts, section 1.4
constexpr int kClipsThatStay = 2;
constexpr double kTight = 0.999;  // closure of a clip

}  // namespace

OperationJudge::OperationJudge() = default;

void OperationJudge::Clear(bool has_view) {
  has_view_ = has_view;
  errors_.Clear();
  view_ = training::CriticalView();
  phases_ = training::PhaseRecogniser();
  was_achieved_ = false;
  act_count_ = 0;
}

void OperationJudge::Report(OperationError error, const Vec3& p, int hand, double time) noexcept {
  errors_.Add({error, time, p, hand});
}

void OperationJudge::Note(const training::Triplet& triplet, int hand) noexcept {
  for (const HandAct& act : Acts()) {
    if (act.triplet == triplet && act.hand == hand) return;
  }
  if (act_count_ < acts_.size()) acts_[act_count_++] = {triplet, hand};
}

void OperationJudge::OnClip(const ClipResult& clip, const VesselMap& map, const Vec3& p, int hand,
                            double time) noexcept {
  if (clip.kind == ClipResult::Kind::kLost) {
    Report(OperationError::kClipDropped, p, hand, time);
    return;
  }
  const VesselRole role = map.anatomy.roles[map.Find(clip.place.tube, clip.place.arc).vessel];
  if (!MayBeDivided(role)) Report(OperationError::kWrongStructureClipped, p, hand, time);
  if (has_view_ && !was_achieved_) Report(OperationError::kClipBeforeCriticalView, p, hand, time);
  if (clip.is_crossed) Report(OperationError::kClipCrossed, p, hand, time);
  if (clip.kind == ClipResult::Kind::kPartial) Report(OperationError::kClipPartial, p, hand, time);
}

namespace {

/// Tight clips between a place of a vessel and the side that stays: the one that joins another tube, or comes from the liver.
int CountStayingClips(const VesselPlace& at, const VesselWork& vessels) noexcept {
  const VesselMap& map = vessels.Map();
  const auto& junctions = map.anatomy.gallbladder;
  const bool is_gallbladder_at_from =
      std::find(junctions.begin(), junctions.end(), map.network.Vessels()[at.vessel].from) != junctions.end();
  const auto& clips = vessels.Acts().clips;
  return static_cast<int>(std::count_if(clips.begin(), clips.end(), [&](const surgery::VesselClip& clip) {
    return clip.vessel == at.vessel && clip.closure >= kTight &&
           (clip.position > at.position) == is_gallbladder_at_from;
  }));
}

}  // namespace

void OperationJudge::OnCut(const TubePlace& place, const VesselWork& vessels, const Vec3& p, int hand,
                           double time) noexcept {
  const VesselMap& map = vessels.Map();
  const VesselPlace at = map.Find(place.tube, place.arc);
  const VesselRole role = map.anatomy.roles[at.vessel];
  if (!MayBeDivided(role)) {
    Report(OperationError::kWrongStructureCut, p, hand, time);
    return;
  }
  const int stay = CountStayingClips(at, vessels);
  // a second cut of what is divided already closes nothing and opens nothing
  if (vessels.CountCuts(place.tube) > 1) return;
  if (stay == 0) Report(OperationError::kUnclippedCut, p, hand, time);
  if (stay > 0 && stay < kClipsThatStay) Report(OperationError::kTooFewClips, p, hand, time);
}

void OperationJudge::OnHole(const TubePlace& place, const VesselWork& vessels, const Vec3& p, int hand,
                            double time) noexcept {
  const VesselPlace at = vessels.Map().Find(place.tube, place.arc);
  if (!MayBeDivided(vessels.Map().anatomy.roles[at.vessel])) {
    Report(OperationError::kWrongStructureBurnt, p, hand, time);
  } else if (CountStayingClips(at, vessels) == 0) {
    Report(OperationError::kUnclippedCut, p, hand, time);
  }
}

void OperationJudge::Update(const DissectionWatch& watch, const surgery::FluidLedger& fluids, bool is_in_bag,
                            bool is_leaving, const Vec3& p_pool, double time, double seconds) noexcept {
  view_.Update(watch.Facts(), seconds);
  was_achieved_ = was_achieved_ || view_.Score().IsAchieved();
  std::array<training::Triplet, 16> triplets;
  for (std::size_t i = 0; i < act_count_; ++i) triplets[i] = acts_[i].triplet;
  phases_.Update(std::span(triplets).first(act_count_), {watch.IsGallbladderFree(), is_in_bag, is_leaving},
                 seconds);
  act_count_ = 0;
  if (fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left > kMuchBlood &&
      errors_.Count(OperationError::kBleeding) == 0)
    Report(OperationError::kBleeding, p_pool, -1, time);
}

}  // namespace trocar::session
