// SPDX-License-Identifier: Apache-2.0
// What hands and camera are told to do, one after the other.
#include <algorithm>
#include <cmath>

#include "task_surgeon.h"

namespace trocar::session {
namespace {

/// Before a thing the open jaws wait this far back along the shaft [m]; behind the grip they close [m].
constexpr double kApproach = 0.022, kBite = 0.001;
/// How far a tool goes back from what it has let go [m].
constexpr double kWithdrawal = 0.025;
/// Higher than straight, on the way to another place [m].
constexpr double kShyness = 0.012;
constexpr double kWideOpen = 0.35;  // beyond the opening at which a thing was held [rad]

}  // namespace

void TaskSurgeon::Add(std::string doing, std::function<void(const Snapshot&)> begin,
                      std::function<bool(const Snapshot&)> is_done, double patience) {
  acts_.push_back({std::move(doing), std::move(begin), std::move(is_done), patience});
}

void TaskSurgeon::Reach(int hand, const std::function<Vec3(const Snapshot&)>& p_world_tip, double hurry) {
  Add(
      "reach",
      [this, hand, p_world_tip, hurry](const Snapshot& seen) {
        HandOf(hand).MoveTo(p_world_tip(seen), hurry);
      },
      [this, hand](const Snapshot&) { return !HandOf(hand).IsMoving() && !HandOf(hand).IsTurning(); }, 15.0);
}

void TaskSurgeon::ReachPoint(int hand, const Vec3& p_world_tip, double hurry) {
  Reach(
      hand, [p_world_tip](const Snapshot&) { return p_world_tip; }, hurry);
}

Vec3 TaskSurgeon::GripTip(const Snapshot& seen, int hand, int object, int grip, double back) const {
  const auto o = static_cast<std::size_t>(object);
  const math::Pose& X = seen.objects[o].X_world_object;
  const auto& grips = scene_->objects[o].grips;
  const Vec3 p =
      grips.empty() ? X.translation : X * grips[static_cast<std::size_t>(grip) % grips.size()].point;
  const Vec3 along = math::Normalized(p - hands_[static_cast<std::size_t>(hand)].Port());
  return p + (kBite - back) * along;
}

void TaskSurgeon::PickUp(int hand, int object, int grip) {
  const auto o = static_cast<std::size_t>(object);
  const auto& grips = scene_->objects[o].grips;
  const ObjectGrip chosen =
      grips.empty() ? ObjectGrip{} : grips[static_cast<std::size_t>(grip) % grips.size()];
  const std::string& name = scene_->objects[o].name;
  Add(
      "reach for " + name,
      [this, hand, object, grip, chosen](const Snapshot& seen) {
        HandMotion& motion = HandOf(hand);
        const Vec3 tip = GripTip(seen, hand, object, grip, kApproach);
        const Vec3 across = math::Rotate(
            seen.objects[static_cast<std::size_t>(object)].X_world_object.rotation, chosen.across);
        motion.SetJaw(chosen.opening);
        motion.Turn(FindSpin(motion.Port(), tip, across));
        const bool is_far = std::hypot(tip.x - motion.Tip().x, tip.y - motion.Tip().y) > 2 * kShyness;
        motion.MoveTo(tip + Vec3{0, 0, is_far ? kShyness : 0});
      },
      [this, hand](const Snapshot&) { return !HandOf(hand).IsMoving() && !HandOf(hand).IsTurning(); }, 15.0);
  const bool misses = random_.Uniform() < skill_.miss_share;
  const Vec3 beside = misses ? Vec3{0, 0, 0.007} : Vec3{};
  Reach(
      hand,
      [this, hand, object, grip, beside](const Snapshot& seen) {
        return GripTip(seen, hand, object, grip, 0) + beside;
      },
      0.6);
  Add(
      "close on " + name, [this, hand](const Snapshot&) { HandOf(hand).SetJaw(0.0); },
      [hand, object](const Snapshot& seen) {
        return seen.instruments[static_cast<std::size_t>(hand)].object == object;
      },
      1.2);
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
  Reach(
      hand,
      [this, hand, object, p_world_object](const Snapshot& seen) {
        return FindTip(seen, hand, object, p_world_object);
      },
      hurry);
}

void TaskSurgeon::Rise(int hand, double height) {
  if (height <= 0) return;
  Reach(hand, [this, hand, height](const Snapshot&) { return HandOf(hand).Tip() + Vec3{0, 0, height}; });
}

void TaskSurgeon::LetGo(int hand) {
  Add(
      "let go",
      [this, hand](const Snapshot& seen) {
        HandOf(hand).SetJaw(seen.instruments[static_cast<std::size_t>(hand)].joints.jaw + kWideOpen);
      },
      [this, hand](const Snapshot& seen) {
        return seen.instruments[static_cast<std::size_t>(hand)].object < 0 && !HandOf(hand).IsTurning();
      });
}

void TaskSurgeon::WithDraw(int hand) {
  Reach(hand, [this, hand](const Snapshot&) { return HandOf(hand).BehindTip(kWithdrawal); });
}

void TaskSurgeon::Look(const Region& region, double distance) {
  const auto joints = FindView(scene_->laparoscope, {region.centre, distance, region.facing});
  if (!joints) return Wait(0.5);
  Add(
      "look at " + region.name, [this, to = *joints](const Snapshot&) { MoveCamera(to); },
      [this](const Snapshot&) { return camera_time_ >= camera_duration_; }, 20.0);
}

void TaskSurgeon::Wait(double seconds) {
  Add(
      "wait", {}, [this, seconds](const Snapshot&) { return act_seconds_ >= seconds; }, seconds + 1.0);
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

}  // namespace trocar::session
