// SPDX-License-Identifier: Apache-2.0
#include "cholecystectomy_goals.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using instrument::ToolKind;
using math::Vec3;
using scene::AssistantCommand;

namespace {

using cholecystectomy::Phase;
using Kind = SurgeonAct::Kind;

constexpr double kFirstLook = 0.090, kLastLook = 0.100;             // of the lens [m]
constexpr double kAlongDuct = 0.006, kOffBed = 0.003, kOff = 0.03;  // of the first and the last draw [m]
constexpr double kOutOfTheWay = 0.080;  // of a tool that waits while the bag leaves [m]

/// The assistant lifts the fundus; the left hand takes the neck and draws it off the duct.
void Expose(const OperationGoal&, const PatientKnowledge& known, ActList& plan) {
  const Place neck = Place::AtNode(known.neck);
  plan.Assist(AssistantCommand::kRetract);
  plan.LookAt(neck, 0.0, kFirstLook);
  plan.HoldOn(neck);
  plan.DrawGently(kLeft, kAlongDuct * math::Normalized(known.DuctAtRest()) + kOffBed * known.bed_normal);
}

/// Every tube that enters the gallbladder.
void Divide(const OperationGoal& goal, const PatientKnowledge& known, ActList& plan) {
  SurgeonAct& act = plan.Decide(goal.kind, goal.doing);
  act.tubes = known.entering;
  act.count = goal.rounds;
}

void BringOut(const OperationGoal&, const PatientKnowledge& known, ActList& plan) {
  plan.Assist(AssistantCommand::kRelease);
  plan.DrawGently(kLeft, kOff * known.bed_normal);
  const Place middle = Place::Of(Place::Kind::kGallbladder);
  plan.LookAt(middle, 0.0, kLastLook);
  plan.Exchange(kRight, ToolKind::kBag);
  plan.Reach(kRight, middle);
  plan.Add(Kind::kCloseBag, "close the bag", 4.0);
  plan.LetGo(kLeft);
  // the bag goes by where the left hand's tool lies
  plan.Reach(kLeft, Place::BehindTip(kLeft, kOutOfTheWay));
  plan.Exchange(kRight, ToolKind::kHook);
  // it ends with the bag outside, not with a tool's jaws
  plan.acts.pop_back();
  plan.acts.back().kind = Kind::kTakeOut;
}

void BailOutWithStumps(Planning& on, const SurgeonAct&) {
  on.memory.BailOut(
      "a duct or artery that enters the gallbladder has no room for clips and a cut between them");
}

void BailOutOnBed(Planning& on, const SurgeonAct&) {
  on.memory.BailOut(
      "duct and artery are divided, but the gallbladder does not come off its bed whatever it is held by");
}

constexpr std::nullptr_t kNoRound = nullptr, kGoOn = nullptr;

// Without the view nothing is clipped; a gallbladder that is still tied is not taken off its bed.
// clang-format off
constexpr OperationGoal kGoals[] = {
  // goal                   its phase                         told meanwhile               rounds           reached when      a round           without it
  {.phase = Phase::kPreparation, .doing = "expose", .write = Expose},
  {Kind::kClearTriangle,    Phase::kCalotTriangleDissection,  "look at the triangle",      4,               IsTriangleDone,   SpreadTriangle,   OpenTriangle, true},
  {Kind::kFreeLowerThird,   Phase::kCalotTriangleDissection,  "look at the bed",           4,               IsLowerThirdDone, FreeLowerThird,   TurnToFundus},
  {Kind::kShowCriticalView, Phase::kCalotTriangleDissection,  "look for what is missing",  kViewRounds,     IsViewShown,      ShowCriticalView, kGoOn},
  {Kind::kTimeOut,          Phase::kCalotTriangleDissection,  "time-out",                  0,               HasSeenView,      kNoRound,         BailOutWithoutView},
  {Kind::kDivide,           Phase::kClippingCutting,          "plan the clips",            kDivisionRounds, AreAllDivided,    ClipAndCut,       kGoOn, false, Divide},
  {Kind::kStopBleeding,     Phase::kClippingCutting,          "look for blood",            4,               IsDry,            CoagulateLeak,    kGoOn},
  {Kind::kCheckStumps,      Phase::kClippingCutting,          "look at the stumps",        0,               AreStumpsThere,   kNoRound,         BailOutWithStumps},
  {Kind::kFreeFromBed,      Phase::kGallbladderDissection,    "look at the bed",           12,              IsOffBed,         FreeFromBed,      BailOutOnBed},
  {.phase = Phase::kGallbladderPackaging, .doing = "bring out", .write = BringOut},
};
// begun by TurnToFundus
constexpr OperationGoal kFundusFirst =
  {Kind::kFundusFirst,      Phase::kGallbladderDissection,    "fundus first",              12,              IsFundusFirstDone, FreeFromFundus,  kGoOn};
// clang-format on

/// Steps of goals that are decided when they are reached.
constexpr struct {
  Kind kind;
  void (*plan)(Planning&, const SurgeonAct&);
} kSteps[] = {
    {Kind::kChooseHold, ChooseHold},
    {Kind::kTakeHold, TakeHold},
    {Kind::kCheckHold, CheckHold},
    {Kind::kTake, TakeTool},
    {Kind::kCheckTriangle, HookTriangle},
    {Kind::kTurnNeck, TurnNeck},
    {Kind::kGoRoundDuct, GoRoundDuct},
    {Kind::kDivideExtraArtery, DivideExtraArtery},
    {Kind::kFollowWithCamera, FollowWithCamera},
    {Kind::kLookFromSide, LookFromSide},
    {Kind::kLookPastShaft, LookPastShaft},
    {Kind::kGoOnDividing, GoOnDividing},
    {Kind::kCheckClip, CheckClip},
    {Kind::kCheckClosedClip, CheckClosedClip},
    {Kind::kCheckBlades, CheckBlades},
    {Kind::kCheckBeforeCut, CheckBeforeCut},
    {Kind::kCheckDivision, CheckDivision},
    {Kind::kCheckPlacedClip, CheckPlacedClip},
    {Kind::kCoagulate, Coagulate},
};

const OperationGoal* FindGoal(Kind kind) {
  if (kind == kFundusFirst.kind) return &kFundusFirst;
  const auto* goal = std::find_if(std::begin(kGoals), std::end(kGoals), [&](const OperationGoal& one) {
    return one.is_reached && one.kind == kind;
  });
  return goal == std::end(kGoals) ? nullptr : goal;
}

/// Of clips and cuts.
bool IsOfDivision(Kind kind) {
  return kind == Kind::kLineUpClip || kind == Kind::kLineUpScissors || kind == Kind::kDivideExtraArtery ||
         (kind >= Kind::kGoOnDividing && kind <= Kind::kCheckDivision);
}

void Pursue(const OperationGoal& goal, Planning& on, const SurgeonAct& act) {
  if (goal.is_reached(on, act)) return;
  if (act.count <= 0) {
    if (goal.without != nullptr) goal.without(on, act);
    return;
  }
  SurgeonAct again = act;
  --again.count;
  goal.attempt(on, act, again);
  if (!goal.plans_again) on.plan.acts.push_back(std::move(again));
}

}  // namespace

std::span<const OperationGoal> CholecystectomyGoals() {
  return kGoals;
}

std::optional<Phase> FindPlannedPhase(
    const std::deque<SurgeonAct>& acts,
    const std::array<scene::InstrumentSetup, instrument::kHandCount>& instruments) {
  // acts of a goal's round stand before the goal itself, which is next again
  bool divides = false;
  for (std::size_t i = 0; i < acts.size(); ++i) {
    const SurgeonAct& act = acts[i];
    divides = divides || IsOfDivision(act.kind);
    const OperationGoal* goal = FindGoal(act.kind);
    if (goal == nullptr) continue;
    if (divides) return Phase::kClippingCutting;
    const bool is_untried = act.kind == Kind::kClearTriangle && act.count == goal->rounds && !act.is_on;
    return is_untried && i > 0 ? Phase::kPreparation : goal->phase;
  }
  if (acts.front().kind == Kind::kTakeOut) return Phase::kGallbladderRetraction;
  const bool is_bag_to_come = std::any_of(acts.begin() + 1, acts.end(), [&](const SurgeonAct& act) {
    const auto& tray = instruments[static_cast<std::size_t>(act.hand)].tray;
    return act.kind == Kind::kExchange && act.tool < tray.size() && tray[act.tool].kind == ToolKind::kBag;
  });
  return is_bag_to_come ? Phase::kGallbladderDissection : Phase::kGallbladderPackaging;
}

void WritePlan(std::span<const OperationGoal> goals, const PatientKnowledge& known, ActList& plan) {
  for (const OperationGoal& goal : goals) {
    if (goal.write != nullptr) {
      goal.write(goal, known, plan);
    } else {
      plan.Decide(goal.kind, goal.doing).count = goal.rounds;
    }
  }
}

void PlanOn(Planning& on, const SurgeonAct& act) {
  if (const OperationGoal* goal = FindGoal(act.kind)) return Pursue(*goal, on, act);
  for (const auto& step : kSteps)
    if (step.kind == act.kind) step.plan(on, act);
}

}  // namespace trocar::agent
