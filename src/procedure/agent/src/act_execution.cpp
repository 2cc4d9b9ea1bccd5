// SPDX-License-Identifier: Apache-2.0
#include "act_execution.h"

#include "cholecystectomy_steps.h"
#include "find_place.h"
#include "planner_fields.h"
#include "tool_alignment.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;

namespace {

using Kind = SurgeonAct::Kind;

constexpr double kPull = 12.0;       // at which a hand stops to draw [N]
constexpr double kNoPull = 0.8;      // [N]
constexpr double kEaseStep = 0.003;  // [m]
constexpr double kDrawHurry = 0.25, kEaseHurry = 0.5;
constexpr double kJawSeconds = 0.6;        // for jaws to open or close
constexpr double kJawCloseSeconds = 0.7;   // likewise over a vessel
constexpr double kLineUpStandOff = 0.012;  // of a tool's tip from a place along a tube's length [m]
constexpr double kSlipped = 0.5;           // after which the other hand takes hold anew [s]

void BeginLook(const SurgeonAct& act, const SurgeonView& view, OperationMemory& memory) {
  memory.camera.field = act.place;
  const Vec3 p = FindPlace(view, act.place, {memory.aim, memory.camera.field});
  const Vec3 to_eye = math::Normalized(view.scene.laparoscope.p_world_port - p);
  const Vec3 along = view.TubeDirection(view.known.cystic_duct, 0.5);
  AimCamera(memory.camera, view.scene.laparoscope, p,
            math::Rotate(math::RotationAbout(along, act.amount), to_eye), act.distance);
}

HandGoal LineUpOnTube(const SurgeonAct& act, const SurgeonView& view) {
  return LineUpAcross(view.Hand(kRight).Port(), view.TubePoint(act.tube, act.share),
                      view.TubeDirection(act.tube, act.share), kLineUpStandOff, act.amount);
}

/// Draws on until the pull is felt. \return whether it is over
bool StepDraw(const SurgeonAct& act, const SurgeonView& view, HandMotion& hand) {
  const bool is_tight = math::Norm(view.Tool(act.hand).force) > kPull;
  if (is_tight) hand.MoveTo(hand.Tip());
  if (is_tight && act.amount != 0) hand.Turn(hand.Spin());
  return is_tight || (!hand.IsMoving() && (act.amount == 0 || !hand.IsTurning()));
}

/// Gives way to the pull. \return whether hardly any is felt
bool StepEase(const SurgeonAct& act, const SurgeonView& view, HandMotion& hand) {
  const Vec3& force = view.Tool(act.hand).force;
  if (math::Norm(force) < kNoPull) return true;
  if (!hand.IsMoving()) hand.MoveTo(hand.Tip() + kEaseStep * math::Normalized(force), kEaseHurry);
  return false;
}

/// Dissects on; when the left hand has slipped, it takes hold anew first. \return whether it is over
bool StepHookWork(const SurgeonView& view, OperationMemory& memory, double seconds, ActList& plan) {
  memory.unheld_seconds =
      view.Tool(kLeft).is_grasping ? 0.0 : memory.unheld_seconds + view.scene.tick_seconds;
  if (memory.unheld_seconds <= kSlipped || memory.dissection.holds_left <= 0)
    return StepDissection(SeeHook(view), memory.dissection, memory.heat, seconds,
                          {memory.Hand(kRight), memory.Hand(kLeft), memory.controls[kRight].coagulate});
  Planning on{view, memory, plan};
  HoldAnewAndGoOn(on);
  return true;
}

}  // namespace

void BeginAct(const SurgeonAct& act, const SurgeonView& view, OperationMemory& memory) {
  HandMotion& hand = memory.Hand(act.hand);
  scene::HandControls& controls = memory.controls[static_cast<std::size_t>(act.hand)];
  switch (act.kind) {
    case Kind::kAssist:
      memory.assistant = act.command;
      break;
    case Kind::kReach:
      hand.MoveTo(FindPlace(view, act.place, {memory.aim, memory.camera.field}), act.hurry);
      break;
    case Kind::kJaw:
      hand.SetJaw(act.amount * view.ToolOf(act.hand).max_jaw);
      break;
    case Kind::kSetJaw:
      hand.SetJaw(act.amount);
      break;
    case Kind::kExchange:
    case Kind::kTakeOut:
      controls.tool = act.tool;
      break;
    case Kind::kDraw:
      hand.MoveTo(hand.Tip() + act.by, kDrawHurry);
      if (act.amount != 0) hand.Turn(hand.Spin() + act.amount);
      break;
    case Kind::kBurn:
      controls.coagulate = true;
      break;
    case Kind::kRinse:
      controls.rinse = true;
      break;
    case Kind::kAspirate:
      controls.aspirate = true;
      break;
    case Kind::kPressCutPedal:
      controls.cut = true;
      break;
    case Kind::kLiftFoot:
      controls.cut = false;
      break;
    case Kind::kLook:
      BeginLook(act, view, memory);
      break;
    case Kind::kLookFrom:
      memory.camera.to = act.camera;
      break;
    case Kind::kLineUp:
      BeginMotion(memory.Hand(kRight), LineUpOnTube(act, view));
      break;
    case Kind::kLineUpClip:
      BeginMotion(memory.Hand(kRight), LineUpClip(SeeVessels(view), memory.division.tubes[act.tube],
                                                  act.share, memory.division.care, memory.aim));
      break;
    case Kind::kLineUpScissors:
      if (const auto goal = LineUpScissors(SeeVessels(view), memory.division.tubes[act.tube], act.share,
                                           memory.division.care, memory.aim))
        BeginMotion(memory.Hand(kRight), *goal);
      break;
    case Kind::kDissect:
      memory.dissection.traction.p_hold = memory.Hand(kLeft).Tip();
      memory.dissection.traction.drawn = 0;
      memory.unheld_seconds = 0;
      break;
    default:  // waits, or begins with what is seen
      break;
  }
}

bool StepAct(const SurgeonAct& act, const SurgeonView& view, OperationMemory& memory, double& seconds,
             ActList& plan) {
  const auto h = static_cast<std::size_t>(act.hand);
  HandMotion& hand = memory.Hand(act.hand);
  scene::HandControls& controls = memory.controls[h];
  const simulation::OperationSnapshot& operation = view.seen.operation;
  switch (act.kind) {
    case Kind::kAssist:
      return act.command == scene::AssistantCommand::kRelease
                 ? !operation.assistant.is_holding
                 : operation.assistant.is_holding || !operation.assistant.is_there;
    case Kind::kReach:
    case Kind::kLineUp:
    case Kind::kLineUpClip:
    case Kind::kLineUpScissors:
      return !hand.IsMoving() && !hand.IsTurning();
    case Kind::kJaw:
      return seconds > kJawSeconds;
    case Kind::kSetJaw:
      return seconds > kJawCloseSeconds;
    case Kind::kWait:
      return seconds >= act.seconds;
    case Kind::kExchange:
      return operation.tools[h] == act.tool;
    case Kind::kTakeOut:
      return operation.is_completed;
    case Kind::kCloseBag:
      return operation.is_in_bag;
    case Kind::kDraw:
      return StepDraw(act, view, hand);
    case Kind::kEase:
      return StepEase(act, view, hand);
    case Kind::kBurn:
    case Kind::kRinse:
    case Kind::kAspirate:
      if (seconds < act.seconds) return false;
      controls.coagulate = controls.rinse = controls.aspirate = false;
      return true;
    case Kind::kLook:
    case Kind::kLookFrom:
      return memory.camera.HasArrived();
    case Kind::kDissect:
      return StepHookWork(view, memory, seconds, plan);
    case Kind::kSpread:
      return StepSpreading(SeeSpreading(view), memory.spreading, seconds, memory.Hand(kRight));
    default:  // decisions and pedals
      return true;
  }
}

}  // namespace trocar::agent
