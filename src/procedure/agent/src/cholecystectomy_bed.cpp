// SPDX-License-Identifier: Apache-2.0
// The gallbladder off its bed. Holds change, because the old one may have slipped and what is free is drawn elsewhere.
#include <utility>

#include "cholecystectomy_steps.h"
#include "planner_fields.h"
#include "seen_fibres.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::ToolKind;
using math::Vec3;
using scene::AssistantCommand;

namespace {

constexpr double kLowerShare = 0.44;  // of the bed that is freed before the view [-]
constexpr int kFundusRounds = 12;
/// How far the flap is folded back at first [m], and how steeply [-].
constexpr double kFold = 0.030, kFoldUp = 0.6;
constexpr double kFarTraction = 0.070, kNearTraction = 0.028, kFirstDraw = 0.010;  // [m]
constexpr double kBedDistance = 0.100;                                             // of the lens [m]

/// What is free is folded over what is not: there the fibres lie open.
/// \param is_from_fundus  the flap is the fundus, and is folded back towards the neck
void FoldAndDissect(Planning& on, const std::vector<std::uint32_t>& bed, const char* what,
                    bool is_from_fundus) {
  const PatientKnowledge& known = on.view.known;
  const std::vector<std::uint32_t> peel = FindPeelStrands(on.view, bed, is_from_fundus);
  const Place left = Place::MiddleOf(peel);
  const HoldFilter is_free{is_from_fundus ? HoldFilter::Kind::kFundus : HoldFilter::Kind::kFree,
                           known.AlongBed(known.strands[peel[peel.size() / 2]].a)};
  const Vec3 up = kFoldUp * known.bed_normal, back = known.BedBack();
  const Vec3 fold = math::Normalized(is_from_fundus ? up - back : up + back);
  on.plan.Take(ToolKind::kHook);
  on.plan.LookAt(left, 0.0, kBedDistance);
  on.plan.HoldOn(left, kHoldTries, is_free);
  on.plan.DrawGently(kLeft, kFold * fold);
  AddDissection(on, {what, bed, known.BedOrder(bed, is_from_fundus), 1.0, Until(DissectionEnd::kBedStep),
                     kFarTraction, fold, is_free, ShareLeft(on.view, bed)});
}

}  // namespace

bool IsLowerThirdDone(const Planning& on, const SurgeonAct&) {
  return IsLowerThirdFree(on.view) || ShareLeft(on.view, on.view.known.BedStrands(kLowerShare)) == 0.0;
}

void FreeLowerThird(Planning& on, const SurgeonAct&, SurgeonAct&) {
  const PatientKnowledge& known = on.view.known;
  const std::vector<std::uint32_t> lower = known.BedStrands(kLowerShare);
  // by the infundibulum, which is drawn off the liver, to the sides and back over what is not free
  const Vec3 way = math::Normalized(known.bed_normal + known.BedBack());
  on.plan.Take(ToolKind::kHook);
  on.plan.HoldOn(Place::MiddleOf(FindPeelStrands(on.view, lower)), kHoldTries, {HoldFilter::Kind::kNeck});
  on.plan.DrawGently(kLeft, kFirstDraw * way);
  AddDissection(on, {"the lower third of the bed", lower, known.BedOrder(lower), 0.97,
                     Until(DissectionEnd::kLowerThirdFree), kNearTraction, way});
}

void TurnToFundus(Planning& on, const SurgeonAct&) {
  if (on.memory.ways.has_begun_at_fundus) return;
  on.memory.ways.has_begun_at_fundus = true;
  // the assistant lets go of the fundus meanwhile
  on.plan.Assist(AssistantCommand::kRelease);
  on.plan.Decide(SurgeonAct::Kind::kFundusFirst, "fundus first").count = kFundusRounds;
  on.plan.Assist(AssistantCommand::kRetract);
}

/// Free enough, or the last round parted nothing.
bool IsFundusFirstDone(const Planning& on, const SurgeonAct& act) {
  const double left = ShareLeft(on.view, on.view.known.BedStrands(1.0));
  const bool has_gained = act.amount == 0.0 || left < act.amount;
  return IsLowerThirdFree(on.view) || left == 0.0 || !has_gained;
}

void FreeFromFundus(Planning& on, const SurgeonAct&, SurgeonAct& again) {
  const std::vector<std::uint32_t> bed = on.view.known.BedStrands(1.0);
  FoldAndDissect(on, bed, "the gallbladder from the fundus on", true);
  again.amount = ShareLeft(on.view, bed);
}

bool IsOffBed(const Planning& on, const SurgeonAct&) {
  return ShareLeft(on.view, on.view.known.BedStrands(1.0)) == 0.0;
}

void FreeFromBed(Planning& on, const SurgeonAct&, SurgeonAct&) {
  FoldAndDissect(on, on.view.known.BedStrands(1.0), "the gallbladder from its bed", false);
}

}  // namespace trocar::agent
