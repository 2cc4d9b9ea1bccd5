// SPDX-License-Identifier: Apache-2.0
// What hands and camera do, one after the other.
#include <algorithm>
#include <cmath>
#include <utility>

#include "state_fields.h"
#include "task_surgeon.h"
#include "tool_alignment.h"
#include "trocar/math/elementary.h"

namespace trocar::agent {

using math::Vec3;
using scene::CalcLaparoscopePose;
using scene::FindView;
using scene::ObjectGrip;
using simulation::Snapshot;

namespace {

/// Before a thing the open jaws wait this far back along the shaft [m]; behind the grip they close [m].
constexpr double kApproach = 0.022, kBite = 0.001;
/// How far a tool goes back from what it has let go [m].
constexpr double kWithdrawal = 0.025;
/// Higher than straight, on the way to another place [m].
constexpr double kShyness = 0.012;
constexpr double kTipBack = 0.002;  // of a tool that is in again, from where the hand means it to be [m]
constexpr double kWideOpen = 0.35;  // beyond the opening at which a thing was held [rad]

}  // namespace

TaskAct& TaskSurgeon::Reach(TaskAct::Kind kind, int hand, double hurry) {
  TaskAct act;
  act.kind = kind;
  act.doing = "reach";
  act.time_limit = 15.0;
  act.hand = hand;
  act.hurry = hurry;
  Add(std::move(act));
  return acts_.back();
}

void TaskSurgeon::ReachPoint(int hand, const Vec3& p_world_tip, double hurry) {
  Reach(TaskAct::Kind::kReachPoint, hand, hurry).p = p_world_tip;
}

void TaskSurgeon::MoveBy(int hand, const Vec3& by) {
  Reach(TaskAct::Kind::kMoveBy, hand).p = by;
}

/// \param seconds  for the jaws to get there
void TaskSurgeon::SetJaw(std::string doing, int hand, double jaw, double seconds) {
  TaskAct act;
  act.kind = TaskAct::Kind::kSetJaw;
  act.doing = std::move(doing);
  act.hand = hand;
  act.amount = jaw;
  act.seconds = seconds;
  Add(std::move(act));
}

Vec3 TaskSurgeon::GripTip(const Snapshot& seen, int hand, int object, int grip, double back) const {
  const auto o = static_cast<std::size_t>(object);
  const math::Pose& X = seen.objects[o].X_world_object;
  const auto& grips = scene_->objects[o].grips;
  const Vec3 p =
      grips.empty() ? X.translation : X * grips[static_cast<std::size_t>(grip) % grips.size()].point;
  return PointBeyond(hands_[static_cast<std::size_t>(hand)].Port(), p,
                     kBite - back + (back > 0 ? 0.0 : skill_.press));
}

void TaskSurgeon::PickUp(int hand, int object, int grip) {
  const std::string& name = scene_->objects[static_cast<std::size_t>(object)].name;
  TaskAct& approach = Reach(TaskAct::Kind::kReachFor, hand);
  approach.doing = "reach for " + name;
  approach.object = object;
  approach.grip = grip;
  const bool misses = random_.Uniform() < skill_.miss_share;
  TaskAct& enter = Reach(TaskAct::Kind::kReachGrip, hand, 0.6);
  enter.object = object;
  enter.grip = grip;
  enter.p = misses ? Vec3{0, 0, 0.007} : Vec3{};
  TaskAct close;
  close.kind = TaskAct::Kind::kCloseOn;
  close.doing = "close on " + name;
  close.time_limit = 1.2;
  close.hand = hand;
  close.object = object;
  Add(std::move(close));
}

/// Open jaws go where they can close on a thing, across it.
void TaskSurgeon::BeginReachFor(const TaskAct& act, const Snapshot& seen) {
  const auto o = static_cast<std::size_t>(act.object);
  const auto& grips = scene_->objects[o].grips;
  const ObjectGrip chosen =
      grips.empty() ? ObjectGrip{} : grips[static_cast<std::size_t>(act.grip) % grips.size()];
  HandMotion& motion = HandOf(act.hand);
  const Vec3 tip = GripTip(seen, act.hand, act.object, act.grip, kApproach);
  const Vec3 across = math::Rotate(seen.objects[o].X_world_object.rotation, chosen.across);
  motion.SetJaw(chosen.opening);
  motion.Turn(FindSpin(motion.Port(), tip, across));
  const bool is_far = math::Hypot(tip.x - motion.Tip().x, tip.y - motion.Tip().y) > 2 * kShyness;
  motion.MoveTo(tip + Vec3{0, 0, is_far ? kShyness : 0});
}

Vec3 TaskSurgeon::FindTip(const Snapshot& seen, int hand, int object, const Vec3& p_world_object) const {
  const HandMotion& motion = hands_[static_cast<std::size_t>(hand)];
  const auto pose_at = [&](const Vec3& tip) {
    return instrument::CalcToolPose(motion.Port(),
                                    instrument::FindJoints(motion.Port(), tip, motion.Spin(), 0.0));
  };
  const Vec3 p_tool_object = math::Inverse(seen.instruments[static_cast<std::size_t>(hand)].X_world_tool) *
                             seen.objects[static_cast<std::size_t>(object)].X_world_object.translation;
  Vec3 tip = motion.Tip();
  for (int round = 0; round < 8; ++round) tip = tip + (p_world_object - pose_at(tip) * p_tool_object);
  return tip;
}

void TaskSurgeon::Carry(int hand, int object, const Vec3& p_world_object, double hurry) {
  TaskAct& act = Reach(TaskAct::Kind::kCarry, hand, hurry);
  act.object = object;
  act.p = p_world_object;
}

void TaskSurgeon::Rise(int hand, double height) {
  if (height > 0) MoveBy(hand, {0, 0, height});
}

void TaskSurgeon::LetGo(int hand) {
  TaskAct act{TaskAct::Kind::kLetGo, "let go"};
  act.hand = hand;
  Add(std::move(act));
}

void TaskSurgeon::WithDraw(int hand) {
  Reach(TaskAct::Kind::kGoBack, hand).amount = kWithdrawal;
}

void TaskSurgeon::Look(const scene::Region& region, double distance) {
  const auto joints = FindView(scene_->laparoscope, {region.centre, distance, region.facing});
  if (!joints) return Wait(0.5);
  TaskAct act{TaskAct::Kind::kLook, "look at " + region.name, 20.0};
  act.camera = *joints;
  Add(std::move(act));
}

void TaskSurgeon::Wait(double seconds) {
  TaskAct act{TaskAct::Kind::kWait, "wait", seconds + 1.0};
  act.seconds = seconds;
  Add(std::move(act));
}

void TaskSurgeon::MoveCamera(const instrument::TrocarJoints& to) {
  const math::Pose a = CalcLaparoscopePose(scene_->laparoscope, camera_),
                   b = CalcLaparoscopePose(scene_->laparoscope, to);
  camera_from_ = camera_;
  camera_to_ = to;
  camera_to_.spin = camera_.spin + std::remainder(to.spin - camera_.spin, 2 * M_PI);
  camera_time_ = 0;
  camera_duration_ =
      std::max({0.6, 1.9 * math::Distance(a.translation, b.translation) / skill_.camera_speed,
                1.9 * std::fabs(camera_to_.spin - camera_.spin) / 1.5,
                1.9 * std::fabs(to.pan - camera_.pan) / 0.8, 1.9 * std::fabs(to.tilt - camera_.tilt) / 0.8});
}

void TaskSurgeon::StepCamera(double dt) {
  if (camera_time_ >= camera_duration_) return;
  camera_time_ = std::min(camera_time_ + dt, camera_duration_);
  const double t = camera_time_ / camera_duration_;
  const double s = t * t * t * (10 + t * (-15 + 6 * t));
  const auto blend = [s](double a, double b) { return a + s * (b - a); };
  camera_ = {blend(camera_from_.pan, camera_to_.pan), blend(camera_from_.tilt, camera_to_.tilt),
             blend(camera_from_.spin, camera_to_.spin), blend(camera_from_.depth, camera_to_.depth), 0.0};
}

void TaskSurgeon::Begin(const TaskAct& act, const Snapshot& seen) {
  using Kind = TaskAct::Kind;
  HandMotion& hand = HandOf(act.hand);
  scene::HandControls& controls = controls_[static_cast<std::size_t>(act.hand)];
  if (skill_.anticipation > 0) Anticipate(act, seen);
  switch (act.kind) {
    case Kind::kReachPoint:
      return hand.MoveTo(act.p, act.hurry);
    case Kind::kReachGrip:
      return hand.MoveTo(GripTip(seen, act.hand, act.object, act.grip, 0) + act.p, act.hurry);
    case Kind::kReachSpot:
      return hand.MoveTo(PointBeyond(hand.Port(), act.spot.At(seen), act.amount), act.hurry);
    case Kind::kMoveBy:
      return hand.MoveTo(hand.Tip() + act.p, act.hurry);
    case Kind::kGoBack:
      return hand.MoveTo(hand.BehindTip(act.amount), act.hurry);
    case Kind::kCarry:
      return hand.MoveTo(FindTip(seen, act.hand, act.object, act.p), act.hurry);
    case Kind::kReachFor:
      return BeginReachFor(act, seen);
    case Kind::kCloseOn:
      return hand.SetJaw(0.0);
    case Kind::kLetGo:
      return hand.SetJaw(seen.instruments[static_cast<std::size_t>(act.hand)].joints.jaw + kWideOpen);
    case Kind::kSetJaw:
      return hand.SetJaw(act.amount);
    case Kind::kLook:
      return MoveCamera(act.camera);
    case Kind::kExchangeTool:
      controls.tool = act.tool;
      return;
    case Kind::kLineUp:
      return BeginLineUp(act, seen);
    case Kind::kFollowSheet:
      return BeginFollowSheet(act);
    case Kind::kReachBand:
      return BeginReachBand(act);
    case Kind::kPressPedal:
    case Kind::kBurnBand:
      controls.coagulate = true;
      return;
    case Kind::kPressCutPedal:
      controls.cut = true;
      return;
    case Kind::kLiftFoot:
      controls.cut = false;
      return;
    case Kind::kWait:
    case Kind::kPass:
      return;
  }
}

bool TaskSurgeon::IsDone(const TaskAct& act, const Snapshot& seen) {
  using Kind = TaskAct::Kind;
  const auto h = static_cast<std::size_t>(act.hand);
  const bool has_arrived = !hands_[h].IsMoving() && !hands_[h].IsTurning();
  switch (act.kind) {
    case Kind::kCloseOn:
      return seen.instruments[h].object == act.object;
    case Kind::kLetGo:
      return seen.instruments[h].object < 0 && !hands_[h].IsTurning();
    case Kind::kSetJaw:
      return act_seconds_ > act.seconds;
    case Kind::kLook:
      return camera_time_ >= camera_duration_;
    case Kind::kWait:
      return act_seconds_ >= act.seconds;
    case Kind::kExchangeTool:
      return seen.operation.tools[h] == act.tool &&
             math::Distance(seen.instruments[h].X_world_device.translation, hands_[h].Tip()) < kTipBack;
    case Kind::kLineUp:
      return has_arrived && seen.instruments[h].joints.jaw > 0.95 * act.amount;
    case Kind::kPressPedal:
      if (act_seconds_ < act.seconds) return false;
      controls_[h].coagulate = false;
      return true;
    case Kind::kBurnBand:
      if (seen.operation.band_is_whole[static_cast<std::size_t>(act.object)] != 0) return false;
      controls_[h].coagulate = false;
      return true;
    case Kind::kPass:
    case Kind::kPressCutPedal:
    case Kind::kLiftFoot:
      return true;
    default:  // what moves a tip
      return has_arrived;
  }
}

void TissueSpot::VisitState(base::StateArchive& archive) {
  archive.Field("a", a);
  archive.Field("b", b);
  archive.Field("t", t);
}

void TaskAct::VisitState(base::StateArchive& archive) {
  archive.Field("kind", kind);
  archive.Field("doing", doing);
  archive.Field("time_limit", time_limit);
  archive.Field("hand", hand);
  archive.Field("object", object);
  archive.Field("grip", grip);
  archive.Field("tool", tool);
  archive.Field("p", p);
  archive.Field("q", q);
  archive.Field("spot", spot);
  archive.Field("hurry", hurry);
  archive.Field("amount", amount);
  archive.Field("seconds", seconds);
  archive.Field("camera", camera);
}

}  // namespace trocar::agent
