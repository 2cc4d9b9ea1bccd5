// SPDX-License-Identifier: Apache-2.0
// What careless surgeons do, each one thing and once.
#include "task_surgeon.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::RegionMark;

namespace {

constexpr double kHighEnough = 0.035;  // above where a thing lay, that it falls when it is dropped [m]
constexpr double kFarOut = 0.16;       // sideways of the field [m]
constexpr double kAstray = 0.015;      // of a thing on its path [m]
constexpr double kTooDeep = 0.012;     // of a tip below the board [m]
constexpr double kBehindJaws = 0.030;  // [m]
constexpr double kApart = 0.030;       // of hands that pull at one thing [m]

}  // namespace

/// While something is carried. \return whether the plan now is to err
/// \param on_path  the thing is led along something and cannot be lifted away
bool TaskSurgeon::AddErrorScenario(const simulation::Snapshot& seen, int hand, int object, bool on_path) {
  const Vec3 here = seen.objects[static_cast<std::size_t>(object)].X_world_object.translation;
  const auto rise = [&] {
    if (seen.instruments[static_cast<std::size_t>(1 - hand)].object >= 0) WithDraw(hand);
    if (!on_path) Rise(hand, kHighEnough);
  };
  switch (error_scenario_) {
    case ErrorScenario::kDrops:
      rise();
      LetGo(hand);
      WithDraw(hand);
      break;
    case ErrorScenario::kLoses: {
      const double side = hand == kLeft ? -1 : 1;
      rise();
      Carry(hand, object, here + Vec3{side * kFarOut, 0, kHighEnough});
      LetGo(hand);
      WithDraw(hand);
      break;
    }
    case ErrorScenario::kTouchesWire:
      Carry(hand, object, here + Vec3{0, 0, kAstray}, 0.5);
      Carry(hand, object, here, 0.5);
      break;
    case ErrorScenario::kPullsApart: {
      const int other = 1 - hand;
      rise();
      PickUp(other, object, other);
      Wait(0.3);
      MoveBy(other, {other == kLeft ? -kApart : kApart, 0, 0});
      break;
    }
    default:
      return false;
  }
  error_scenario_ = ErrorScenario::kNone;
  return true;
}

/// Before a step. \return whether the plan now is to err
bool TaskSurgeon::AddIdleErrorScenario(const simulation::Snapshot& seen) {
  switch (error_scenario_) {
    case ErrorScenario::kPressesBoard: {
      double top = seen.instruments[kLeft].X_world_tool.translation.z;
      for (std::size_t i = 0; i < scene_->objects.size(); ++i) {
        if (!scene_->objects[i].Moves())
          top = std::min(top, scene_->objects[i].body.X_world_body.translation.z);
      }
      const Vec3 tip = HandOf(kLeft).Tip();
      ReachPoint(kLeft, {tip.x, tip.y, top - kTooDeep}, 0.6);
      ReachPoint(kLeft, tip);
      break;
    }
    case ErrorScenario::kLeavesView: {
      const Vec3 tip = HandOf(kRight).Tip();
      ReachPoint(kRight, tip + Vec3{kFarOut, 0, 0.03});
      Wait(4.0);
      ReachPoint(kRight, tip);
      break;
    }
    case ErrorScenario::kClashes: {
      // through the other's shaft, behind its jaws
      const Vec3 left = HandOf(kLeft).Tip(), right = HandOf(kRight).Tip();
      const Vec3 shaft = left + kBehindJaws * math::Normalized(HandOf(kLeft).Port() - left);
      ReachPoint(kRight, shaft + Vec3{0.010, 0, 0}, 0.7);
      ReachPoint(kRight, shaft + Vec3{-0.010, 0, 0}, 0.3);
      ReachPoint(kRight, right);
      break;
    }
    case ErrorScenario::kSmearsLens: {
      for (const scene::Region& region : scene_->task->regions) {
        if (region.mark == RegionMark::kNone) continue;
        Look(region, 0.010);
        break;
      }
      Wait(0.5);
      break;
    }
    case ErrorScenario::kDawdles:  // for ever
      ReachPoint(kLeft, HandOf(kLeft).Tip() + Vec3{0.004, 0, 0});
      ReachPoint(kLeft, HandOf(kLeft).Tip());
      Wait(2.0);
      fruitless_plans_ = 0;
      return true;
    default:
      return false;
  }
  error_scenario_ = ErrorScenario::kNone;
  return true;
}

}  // namespace trocar::agent
