// SPDX-License-Identifier: Apache-2.0
// What the able do besides: the free hand goes ahead. And what the confused do: they begin at the wrong place.
#include <algorithm>
#include <cmath>

#include "task_surgeon.h"
#include "trocar/base/to_integer.h"

namespace trocar::agent {

using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::ConditionKind;
using scene::GoalSnapshot;
using scene::kAnyHand;
using scene::Task;
using simulation::Snapshot;

namespace {

/// Beside and above what it will take, a hand that has gone ahead waits [m].
constexpr double kAheadBeside = 0.020, kAheadAbove = 0.022;
/// It stays on its own side of the field by this much [m], where the other hand's shaft does not pass.
constexpr double kOwnSide = 0.020;
constexpr double kNearEnough = 0.015;  // of a hand to its next work: it stays where it is [m]
constexpr double kOverWrong = 0.022;   // above a thing that is not to be taken [m]
constexpr double kDoubt = 0.6;         // there, until it is found out [s]

bool MovesATip(TaskAct::Kind kind) {
  using Kind = TaskAct::Kind;
  return kind == Kind::kReachPoint || kind == Kind::kReachGrip || kind == Kind::kMoveBy ||
         kind == Kind::kCarry || kind == Kind::kReachFor;
}

}  // namespace

/// Where the first goal that is left for a hand begins.
std::optional<Vec3> TaskSurgeon::FindNextWork(const Snapshot& seen, int hand) const {
  const Task& task = *scene_->task;
  for (std::size_t g = 0; g < task.goals.size(); ++g) {
    const GoalSnapshot& now = seen.task.goals[g];
    if (now.is_done || now.steps_done > 0 || task.goals[g].steps.empty()) continue;
    if (task.goals[g].name == goal_name_ || IsLost(seen, task.goals[g])) continue;
    const scene::Condition& first = task.goals[g].steps.front();
    if (first.kind == ConditionKind::kTipInRegion) {
      const Vec3& p = task.regions[static_cast<std::size_t>(first.regions.front())].centre;
      const int wanted = first.hand != kAnyHand ? first.hand : p.x < 0 ? kLeft : kRight;
      if (wanted != hand) return std::nullopt;
      return p;
    }
    if (first.object < 0 || first.hand != hand) return std::nullopt;
    return seen.objects[static_cast<std::size_t>(first.object)].X_world_object.translation;
  }
  return std::nullopt;
}

/// While one hand moves, the free one goes to where it will be needed next: to where a thing will be passed to it, or
/// above what it will take.
void TaskSurgeon::Anticipate(const TaskAct& act, const Snapshot& seen) {
  const int other = 1 - act.hand;
  const auto o = static_cast<std::size_t>(other);
  if (!MovesATip(act.kind) || hands_[o].IsMoving() || seen.instruments[o].object >= 0) return;
  std::optional<Vec3> work;
  Vec3 carried_to{};
  bool is_carried = false;
  for (const TaskAct& next : acts_) {
    if (next.hand == act.hand && next.kind == TaskAct::Kind::kCarry) {
      carried_to = next.p;
      is_carried = true;
    }
    const bool is_its_act =
        next.hand == other && (MovesATip(next.kind) || next.kind == TaskAct::Kind::kGoBack);
    if (!is_its_act) continue;
    if (next.kind != TaskAct::Kind::kReachFor || !is_carried) return;
    work = carried_to;
    break;
  }
  if (!work) work = FindNextWork(seen, other);
  if (!work || !(random_.Uniform() < skill_.anticipation)) return;
  const double side = other == kLeft ? -1 : 1;
  Vec3 p = *work + Vec3{side * kAheadBeside, 0, kAheadAbove};
  p.x = side * std::max(kOwnSide, side * p.x);
  if (math::Distance(p, HandOf(other).Tip()) > kNearEnough) HandOf(other).MoveTo(p);
}

/// Goes over to what another goal is about, and finds out. \return whether the plan now is to do so
bool TaskSurgeon::BeginAtTheWrongPlace(const Snapshot& seen, std::size_t goal) {
  if (!(random_.Uniform() < skill_.wrong_plan)) return false;
  const Task& task = *scene_->task;
  const auto first =
      base::TruncateTo<std::size_t>(random_.Uniform(0.0, static_cast<double>(task.goals.size())));
  for (std::size_t n = 0; n < task.goals.size(); ++n) {
    const std::size_t g = (first + n) % task.goals.size();
    if (g == goal || task.goals[g].steps.empty()) continue;
    const scene::Condition& step = task.goals[g].steps.front();
    Vec3 p;
    if (step.object >= 0) {
      p = seen.objects[static_cast<std::size_t>(step.object)].X_world_object.translation;
    } else if (!step.regions.empty() && step.kind != ConditionKind::kCameraSees) {
      p = task.regions[static_cast<std::size_t>(step.regions.front())].centre;
    } else {
      continue;
    }
    const int hand = step.hand != kAnyHand ? step.hand : p.x < 0 ? kLeft : kRight;
    if (seen.instruments[static_cast<std::size_t>(hand)].object >= 0) return false;
    ReachPoint(hand, p + Vec3{0, 0, kOverWrong});
    Wait(kDoubt);
    fruitless_plans_ = std::max(0, fruitless_plans_ - 1);  // it was no vain try
    return true;
  }
  return false;
}

}  // namespace trocar::agent
