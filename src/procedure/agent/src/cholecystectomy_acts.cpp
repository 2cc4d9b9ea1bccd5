// SPDX-License-Identifier: Apache-2.0
// How each act begins and when it is done.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cholecystectomy_surgeon.h"
#include "state_fields.h"

namespace trocar::agent {

using instrument::kRight;
using math::Vec3;
using simulation::Snapshot;

namespace {

constexpr double kPull = 12.0;            // at which a hand stops to draw [N]
constexpr double kNoPull = 0.8;           // [N]
constexpr double kEaseStep = 0.003;       // [m]
constexpr double kJawSeconds = 0.6;       // for jaws to open or close
constexpr double kJawCloseSeconds = 0.7;  // likewise over a vessel

}  // namespace

void CholecystectomySurgeon::Begin(const SurgeonAct& act, const Snapshot& seen) {
  using Kind = SurgeonAct::Kind;
  if (act.IsDecision()) {
    std::swap(acts_, inserted_);
    PlanOn(act, seen);
    std::swap(acts_, inserted_);
    return;
  }
  const auto h = static_cast<std::size_t>(act.hand);
  HandMotion& hand = hands_[h];
  switch (act.kind) {
    case Kind::kAssist:
      assistant_ = act.command;
      break;
    case Kind::kReach:
      hand.MoveTo(Find(act.place, seen), act.hurry);
      break;
    case Kind::kJaw:
      hand.SetJaw(act.amount * scene_->instruments[h].tray[seen.operation.tools[h]].max_jaw);
      break;
    case Kind::kSetJaw:
      hand.SetJaw(act.amount);
      break;
    case Kind::kExchange:
    case Kind::kTakeOut:
      controls_[h].tool = act.tool;
      break;
    case Kind::kDraw:
      hand.MoveTo(hand.Tip() + act.by, 0.25);
      if (act.amount != 0) hand.Turn(hand.Spin() + act.amount);
      break;
    case Kind::kBurn:
      controls_[h].coagulate = true;
      break;
    case Kind::kRinse:
      controls_[h].rinse = true;
      break;
    case Kind::kAspirate:
      controls_[h].aspirate = true;
      break;
    case Kind::kPressCutPedal:
      controls_[h].cut = true;
      break;
    case Kind::kLiftFoot:
      controls_[h].cut = false;
      break;
    case Kind::kLook: {
      picture_.field = act.place;
      const Vec3 p = Find(act.place, seen);
      const Vec3 to_eye = math::Normalized(scene_->laparoscope.p_world_port - p);
      const Vec3 along = TubeDirection(seen, FindTube(roles::TubeRole::kCysticDuct), 0.5);
      AimCamera(p, math::Rotate(math::RotationAbout(along, act.amount), to_eye), act.distance);
      break;
    }
    case Kind::kLookFrom:
      picture_.to = act.camera;
      break;
    case Kind::kLineUp:
      LineUpTool(act, seen);
      break;
    case Kind::kLineUpClip:
      LineUpClip(act, seen);
      break;
    case Kind::kLineUpScissors:
      LineUpScissors(act, seen);
      break;
    case Kind::kDissect:
      dissection_.traction.p_hold = HandOf(instrument::kLeft).Tip();
      dissection_.traction.drawn = 0;
      unheld_seconds_ = 0;
      break;
    default:  // waits, or begins with what is seen
      break;
  }
}

bool CholecystectomySurgeon::IsDone(const SurgeonAct& act, const Snapshot& seen) {
  using Kind = SurgeonAct::Kind;
  const auto h = static_cast<std::size_t>(act.hand);
  HandMotion& hand = hands_[h];
  switch (act.kind) {
    case Kind::kAssist:
      return act.command == scene::AssistantCommand::kRelease
                 ? !seen.operation.assistant.is_holding
                 : seen.operation.assistant.is_holding || !seen.operation.assistant.is_there;
    case Kind::kReach:
    case Kind::kLineUp:
    case Kind::kLineUpClip:
    case Kind::kLineUpScissors:
      return !hand.IsMoving() && !hand.IsTurning();
    case Kind::kJaw:
      return act_seconds_ > kJawSeconds;
    case Kind::kSetJaw:
      return act_seconds_ > kJawCloseSeconds;
    case Kind::kWait:
      return act_seconds_ >= act.seconds;
    case Kind::kExchange:
      return seen.operation.tools[h] == act.tool;
    case Kind::kTakeOut:
      return seen.operation.is_completed;
    case Kind::kCloseBag:
      return seen.operation.is_in_bag;
    case Kind::kDraw: {
      const bool is_tight = math::Norm(seen.instruments[h].force) > kPull;
      if (is_tight) hand.MoveTo(hand.Tip());
      if (is_tight && act.amount != 0) hand.Turn(hand.Spin());
      return is_tight || (!hand.IsMoving() && (act.amount == 0 || !hand.IsTurning()));
    }
    case Kind::kEase: {
      const Vec3& force = seen.instruments[h].force;
      if (math::Norm(force) < kNoPull) return true;
      if (!hand.IsMoving()) hand.MoveTo(hand.Tip() + kEaseStep * math::Normalized(force), 0.5);
      return false;
    }
    case Kind::kBurn:
    case Kind::kRinse:
    case Kind::kAspirate:
      if (act_seconds_ < act.seconds) return false;
      controls_[h].coagulate = controls_[h].rinse = controls_[h].aspirate = false;
      return true;
    case Kind::kLook:
    case Kind::kLookFrom:
      return picture_.camera == picture_.to;
    case Kind::kDissect:
      return GoOnOrHoldAnew(seen);
    case Kind::kSpread:
      return GoOnSpreading(spreading_, seen);
    default:  // decisions and pedals
      return true;
  }
}

void CholecystectomySurgeon::PlanOn(const SurgeonAct& act, const Snapshot& seen) {
  using Kind = SurgeonAct::Kind;
  switch (act.kind) {
    case Kind::kChooseHold:
      return ChooseHold(act, seen);
    case Kind::kTakeHold:
      return TakeHold(act, seen);
    case Kind::kCheckHold:
      return CheckHold(act, seen);
    case Kind::kTake:
      if (scene_->instruments[kRight].tray[seen.operation.tools[kRight]].kind != act.tool_kind)
        Exchange(kRight, act.tool_kind);
      return;
    case Kind::kClearTriangle:
      return PlanTriangle(act, seen);
    case Kind::kCheckTriangle:
      return CheckTriangle(act, seen);
    case Kind::kFreeLowerThird:
      return PlanLowerThird(act, seen);
    case Kind::kShowCriticalView:
      return PlanCriticalView(act, seen);
    case Kind::kDivideExtraArtery:
      if (const auto extra = FindExtraArtery(seen)) Divide({*extra});
      return;
    case Kind::kFollowWithCamera:
      picture_.follows = act.is_on;
      return;
    case Kind::kLookFromSide:
      return PlanLookFromSide(act, seen);
    case Kind::kLookPastShaft:
      return PlanLookPastShaft(act, seen);
    case Kind::kTimeOut:
      if (!has_view_) BailOut(ExplainMissingView(seen));
      return;
    case Kind::kCheckStumps:
      if (!std::all_of(known_.entering.begin(), known_.entering.end(),
                       [&](std::size_t tube) { return IsDivided(seen, tube); }))
        BailOut("a duct or artery that enters the gallbladder has no room for clips and a cut between them");
      return;
    case Kind::kFreeFromBed:
      return PlanBed(act, seen);
    case Kind::kDivide:
      return PlanDivision(act, seen);
    case Kind::kGoOnDividing:
      return GoOnDividing(seen);
    case Kind::kCheckClip:
      return CheckClip(act, seen);
    case Kind::kCheckClosedClip:
      // it may have gone round another, such as the stump of what is divided already
      if (ClipsOn(seen, division_.tubes[act.tube]).size() <= static_cast<std::size_t>(act.count))
        for (const double gaps : {-1.0, -0.5, 0.0, 0.5, 1.0})
          division_.avoid[act.tube].push_back(act.share + gaps * kLeastGap);
      return;
    case Kind::kCheckBlades:
      return CheckBlades(act, seen);
    case Kind::kCheckBeforeCut:
      return CheckBeforeCut(act, seen);
    case Kind::kCheckDivision:
      if (!IsDivided(seen, division_.tubes[act.tube])) division_.avoid[act.tube].push_back(act.share);
      return;
    case Kind::kCheckPlacedClip:
      return CheckPlacedClip(act, seen);
    case Kind::kStopBleeding:
      return PlanCoagulation(act, seen);
    case Kind::kCoagulate:
      Burn(kRight, act.place, act.seconds);
      return Withdraw();
    case Kind::kTurnNeck:
      return TurnNeck(seen, act.side, act.amount);
    case Kind::kGoRoundDuct:
      return GoRoundDuct(seen, act.amount);
    case Kind::kFundusFirst:
      return PlanFundusFirst(act, seen);
    default:
      return;
  }
}

void CholecystectomySurgeon::VisitState(base::StateArchive& archive) {
  archive.Field("hands", hands_);
  archive.Field("controls", controls_);
  archive.Field("assistant", assistant_);
  archive.Field("camera", picture_.camera);
  archive.Field("camera_to", picture_.to);
  archive.Field("first_azimuth", picture_.first_azimuth);
  archive.Field("has_view", has_view_);
  archive.Field("stops", stops_);
  archive.Field("bail_out", bail_out_);
  archive.Field("triangle_ways_left", triangle_ways_left_);
  archive.Field("sharp_rounds_left", sharp_rounds_left_);
  archive.Field("has_begun_at_fundus", has_begun_at_fundus_);
  archive.Field("fibres_left", progress_.fibres_left);
  archive.Field("stuck_seconds", progress_.stuck_seconds);
  archive.Field("seconds", progress_.seconds);
  VisitQueue(archive, "acts", acts_);
  archive.Field("dissection", dissection_);
  archive.Field("spreading", spreading_);
  archive.Field("division", division_);
  archive.Field("has_begun", has_begun_);
  archive.Field("has_finished", has_finished_);
  archive.Field("act_seconds", act_seconds_);
  archive.Field("field", picture_.field);
  archive.Field("camera_follows", picture_.follows);
  archive.Field("unseen_seconds", picture_.unseen_seconds);
  archive.Field("unheld_seconds", unheld_seconds_);
  archive.Field("missed_holds", missed_holds_);
  archive.Field("heat", heat_);
  archive.Field("beyond", beyond_);
  archive.Field("offset", offset_);
  archive.Field("doing", doing_);
  if (archive.IsRestoring()) trees_tick_ = kNever;
}

}  // namespace trocar::agent
