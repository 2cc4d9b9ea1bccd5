// SPDX-License-Identifier: Apache-2.0
// The hepatocystic triangle: bluntly, beside ducts too; what is left elsewhere, with the hook; the last fibres with scissors.
#include <algorithm>
#include <limits>
#include <utility>

#include "cholecystectomy_steps.h"
#include "planner_fields.h"
#include "seen_fibres.h"
#include "trocar/cholecystectomy/cholecystectomy.h"
#include "turn_planner.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using instrument::ToolKind;
using math::Vec3;
using scene::AssistantCommand;

namespace {

constexpr int kRoundsOfWay = 2;
constexpr double kPedicleWeight = 3.0;  // of fibres on the cystic duct and artery, among others
/// Of the hold about the duct, so that tools come to the other side of the triangle [m].
constexpr double kOpenNeck = 0.014;
constexpr double kSwungAside = 0.050;  // of a gallbladder that hangs free, off the hook's way [m]
constexpr double kFrontWeight = 0.25;  // of a fibre's place from front to back, in its order [-]

/// \param is_second_look  the critical view was looked for and not found
void AddTriangle(Planning& on, int rounds, bool is_second_look) {
  SurgeonAct& act = on.plan.Decide(SurgeonAct::Kind::kClearTriangle, "look at the triangle");
  act.count = rounds;
  act.is_on = is_second_look;
}

/// Works on `memory.spreading`.
void AddSpreading(Planning& on, Spreading work) {
  on.plan.Take(work.is_sharp ? ToolKind::kScissors : ToolKind::kDissector);
  work.tries.assign(work.strands.size(), 0);
  on.plan.Add(SurgeonAct::Kind::kSpread,
              work.is_sharp ? "cut the last fibres" : "spread the hepatocystic triangle", 600.0);
  on.memory.spreading = std::move(work);
}

bool Has(const std::vector<std::uint32_t>& strands, std::uint32_t strand) {
  return std::find(strands.begin(), strands.end(), strand) != strands.end();
}

std::vector<std::uint32_t> FindCovering(const Planning& on) {
  return AreTubesBare(on.view) ? std::vector<std::uint32_t>{} : FindCoveringStrands(on.view);
}

bool IsFatLeft(const Planning& on) {
  return on.view.seen.operation.procedure.Measure(cholecystectomy::kClearedShare) < kCleared;
}

/// A gallbladder that is off its bed stands before the triangle: the assistant lets go of it, and the left hand swings it by the
/// fundus off the hook's way.
void SwingOutOfWay(Planning& on, DissectionGoal& goal) {
  const SurgeonView& view = on.view;
  on.plan.Assist(AssistantCommand::kRelease);
  goal.may = {HoldFilter::Kind::kFundus, std::numeric_limits<double>::infinity()};
  on.plan.HoldOn(Place::Of(Place::Kind::kGallbladder), kHoldTries, goal.may);
  const Vec3 duct = view.TubePoint(view.known.cystic_duct, 0.0);
  const Vec3 in = math::Normalized(duct - view.Hand(kRight).Port());
  const Vec3 off = view.seen.positions[view.known.fundus] - duct;
  goal.traction = kSwungAside;
  goal.way = math::Normalized(off - math::Dot(off, in) * in, view.known.bed_normal);
}

/// A fibre in the corner between duct, artery and gallbladder is too near to them for jaws that open and for current: scissors
/// take it.
/// \return whether there is one that they come to, and they were planned
bool CutLastFibres(Planning& on, const SurgeonAct& act) {
  if (on.memory.ways.sharp <= 0) return false;
  Spreading work;
  work.is_sharp = true;
  for (const std::uint32_t i : FindCoveringStrands(on.view))
    if (on.view.IsIntact(i)) work.strands.push_back(i);
  if (IsFatLeft(on)) {
    for (const std::uint32_t i : on.view.known.window_strands)
      if (!Has(work.strands, i) && on.view.IsIntact(i)) work.strands.push_back(i);
  }
  work.weights.assign(work.strands.size(), 1.0);
  const SeenSpread seen = SeeSpread(on.view, work);
  if (!FindSnip(seen.field, std::vector<std::uint8_t>(seen.index.size(), 0))) return false;
  --on.memory.ways.sharp;
  AddSpreading(on, std::move(work));
  AddTriangle(on, 0, act.is_on);
  return true;
}

HoldPose LeftHold(const Planning& on) {
  const HandMotion& hand = on.view.Hand(kLeft);
  return {hand.Port(), hand.Tip()};
}

TurnAxis DuctAxis(const Planning& on) {
  const std::size_t duct = on.view.known.cystic_duct;
  return {on.view.TubePoint(duct, 0.0), on.view.TubePoint(duct, 1.0)};
}

}  // namespace

bool IsTriangleDone(const Planning& on, const SurgeonAct&) {
  return !IsFatLeft(on) && FindCovering(on).empty();
}

void SpreadTriangle(Planning& on, const SurgeonAct& act, SurgeonAct&) {
  const std::vector<std::uint32_t>& fat = on.view.known.window_strands;
  Spreading work;
  work.strands = FindCovering(on);
  work.weights.assign(work.strands.size(), kPedicleWeight);
  const std::vector<std::uint32_t> covering = work.strands;
  for (const std::uint32_t i : fat) {
    if (Has(covering, i)) continue;
    work.strands.push_back(i);
    work.weights.push_back(1.0);
  }
  AddSpreading(on, std::move(work));
  SurgeonAct& next = on.plan.Decide(SurgeonAct::Kind::kCheckTriangle, "look at the triangle");
  next.strands = fat;
  next.count = act.count;
  next.is_on = act.is_on;
}

void HookTriangle(Planning& on, const SurgeonAct& act) {
  const PatientKnowledge& known = on.view.known;
  if (!IsTriangleClear(on.view)) {
    std::vector<std::uint32_t> left = act.strands;
    const std::vector<std::uint32_t> covering = FindCovering(on);
    left.insert(left.end(), covering.begin(), covering.end());
    std::vector<double> order;
    // the front first
    for (const std::uint32_t i : left)
      order.push_back(-kFrontWeight * (known.rest[known.strands[i].a] + known.rest[known.strands[i].b]).z);
    DissectionGoal goal{"the hepatocystic triangle", left, order, 1.0, Until(DissectionEnd::kTriangleClear)};
    if (HangsFree(on.view)) SwingOutOfWay(on, goal);
    on.plan.Take(ToolKind::kHook);
    AddDissection(on, std::move(goal));
  }
  AddTriangle(on, act.count - 1, act.is_on);
}

/// The left hand turns the neck to one side, then to the other, and takes it elsewhere, as far as ways are left.
void OpenTriangle(Planning& on, const SurgeonAct& act) {
  int& ways_left = on.memory.ways.triangle;
  // fibres on duct and artery alone may come off with the lower third
  if (!IsFatLeft(on) && !act.is_on) return;
  if ((!IsFatLeft(on) || ways_left <= 0) && CutLastFibres(on, act)) return;
  if (ways_left <= 0) return;
  const int way = WaysLeft::kTriangleWays - ways_left--;
  if (way >= WaysLeft::kTriangleWays / 2) on.plan.HoldOn(Place::AtNode(on.view.known.neck));
  SurgeonAct& turn = on.plan.Decide(SurgeonAct::Kind::kTurnNeck, "turn the neck");
  turn.side = way % 2 == 0 ? 1 : -1;
  // the second way comes from the first one's side
  turn.amount = way == 1 ? 2 * kOpenNeck : kOpenNeck;
  AddTriangle(on, kRoundsOfWay, act.is_on);
}

void TurnNeck(Planning& on, const SurgeonAct& act) {
  TurnNeckAside(on, act.side, act.amount, 0.0);
}

void TurnNeckAside(Planning& on, int side, double by, double turn) {
  if (!on.view.Tool(kLeft).is_grasping) return;
  const HoldTurn motion = TurnAside(LeftHold(on), DuctAxis(on), side, by, turn, on.view.known.bed_normal);
  on.plan.DrawGently(kLeft, motion.by, motion.roll);
}

void TakeRoundDuct(Planning& on, double angle) {
  const HoldTurn motion = TakeRound(LeftHold(on), DuctAxis(on), on.view.known.DuctAtRest(), angle);
  if (on.view.seen.operation.assistant.is_holding) on.plan.Assist(AssistantCommand::kRelease);
  on.plan.Ease(kLeft);
  on.plan.DrawGently(kLeft, motion.by, motion.roll);
}

void GoRoundDuct(Planning& on, const SurgeonAct& act) {
  TakeRoundDuct(on, act.amount);
}

}  // namespace trocar::agent
