// SPDX-License-Identifier: Apache-2.0
// The left hand's hold of the gallbladder, the right hand's tool, and the dissection for which both work together.
#include <utility>

#include "cholecystectomy_steps.h"
#include "find_place.h"
#include "hold_planner.h"
#include "planner_fields.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;

namespace {

constexpr double kGrip = 0.07;  // of the jaws: 14 N of pinch

/// The same hold again, one step farther.
SurgeonAct& GoOnHolding(Planning& on, SurgeonAct::Kind kind, const char* doing, const SurgeonAct& act) {
  SurgeonAct& next = on.plan.Decide(kind, doing);
  next.place = act.place;
  next.count = act.count;
  next.may = act.may;
  return next;
}

void GoOnDissecting(Planning& on) {
  on.plan.Add(SurgeonAct::Kind::kDissect, "dissect " + on.memory.dissection.goal.what, 1200.0);
}

}  // namespace

void ChooseHold(Planning& on, const SurgeonAct& act) {
  if (act.count <= 0) return;
  if (on.view.Tool(kLeft).is_grasping) on.plan.LetGo(kLeft);
  GoOnHolding(on, SurgeonAct::Kind::kTakeHold, act.doing.c_str(), act);
}

void TakeHold(Planning& on, const SurgeonAct& act) {
  const math::Vec3 near = FindPlace(on.view, act.place, {on.memory.aim, on.memory.camera.field});
  const std::uint32_t node =
      FindHold(SeeHold(on.view, act.may), near, on.memory.missed_holds).value_or(on.view.known.hold);
  on.plan.Grasp(kLeft, Place::AtNode(node), kGrip);
  GoOnHolding(on, SurgeonAct::Kind::kCheckHold, "look at the hold", act).node = node;
}

void CheckHold(Planning& on, const SurgeonAct& act) {
  const simulation::InstrumentSnapshot& hand = on.view.Tool(kLeft);
  if (hand.is_grasping && hand.organ == on.view.known.gallbladder) return;
  on.memory.missed_holds.push_back(act.node);
  on.plan.LetGo(kLeft);
  on.plan.HoldOn(act.place, act.count - 1, act.may);
}

void TakeTool(Planning& on, const SurgeonAct& act) {
  if (on.view.ToolOf(kRight).kind != act.tool_kind) on.plan.Exchange(kRight, act.tool_kind);
}

void AddDissection(Planning& on, DissectionGoal goal) {
  const math::Vec3 axis = on.view.known.BedAxis();
  const math::Vec3 aside = math::Normalized(math::Cross(on.view.known.bed_normal, axis));
  on.memory.dissection = PlanDissection(std::move(goal), axis, aside);
  GoOnDissecting(on);
}

void HoldAnewAndGoOn(Planning& on) {
  Dissection& work = on.memory.dissection;
  --work.holds_left;
  LeaveFibre(work, on.memory.controls[kRight].coagulate);
  on.plan.HoldOn(Place::Of(Place::Kind::kRightTip), kHoldTries, work.goal.may);
  GoOnDissecting(on);
}

}  // namespace trocar::agent
