// SPDX-License-Identifier: Apache-2.0
#include "task_surgeon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "state_fields.h"

namespace trocar::agent {

using instrument::IsInView;
using instrument::kLeft;
using instrument::kRight;
using math::Vec3;
using scene::ConditionKind;
using scene::GoalSnapshot;
using scene::kAnyHand;
using scene::ObjectSnapshot;
using scene::Region;
using scene::Task;
using scene::TaskPhase;
using simulation::Snapshot;
using surgery::TubePiece;

namespace {

/// A plan that has led nowhere so often is given up.
constexpr int kMostFruitlessPlans = 12;
/// Above where a thing lay and where it goes, it is passed from hand to hand [m].
constexpr double kTransferHeight = 0.045;
/// Above a place a thing is lowered from [m], and let go [m].
constexpr double kAbovePlace = 0.028, kLetGoHeight = 0.0025;

}  // namespace

bool IsDoneByGoals(const scene::Scene& scene) noexcept {
  return scene.task.has_value() && !(scene.HasPatient() && scene.operation);
}

TaskSurgeon::TaskSurgeon(std::shared_ptr<const scene::Scene> scene, const SurgeonSkill& skill,
                         ErrorScenario error_scenario, std::uint64_t seed)
    : scene_(std::move(scene)),
      skill_(skill),
      error_scenario_(error_scenario),
      random_(seed),
      hands_{HandMotion(scene_->instruments[kLeft].p_world_port, scene_->instruments[kLeft].home, skill.hand,
                        2 * seed + 11),
             HandMotion(scene_->instruments[kRight].p_world_port, scene_->instruments[kRight].home,
                        skill.hand, 2 * seed + 12)},
      camera_(scene_->laparoscope.home),
      camera_from_(camera_),
      camera_to_(camera_) {}

scene::Input TaskSurgeon::Act(const Snapshot& seen) {
  const double dt = scene_->tick_seconds;
  if (seen.task.IsOver()) has_finished_ = true;
  if (start_.empty()) {
    start_ = seen.positions;
    const auto pieces =
        std::span(seen.operation.topology.tube_pieces).first(seen.operation.topology.tube_piece_count);
    for (const TubePiece& piece : pieces) start_pieces_.push_back({piece.a, piece.b});
  }
  if (acts_.empty() && !has_finished_) Plan(seen);
  pause_ -= dt;
  while (!acts_.empty() && !has_finished_ && pause_ <= 0) {
    TaskAct& act = acts_.front();
    if (!has_begun_) {
      doing_ = goal_name_ + ": " + act.doing;
      Begin(act, seen);
      has_begun_ = true;
      act_seconds_ = 0;
      break;  // what begins shows in the next tick
    }
    act_seconds_ += dt;
    if (IsDone(act, seen)) {
      acts_.pop_front();
      has_begun_ = false;
      pause_ = random_.Uniform(0.0, skill_.pause);
    } else if (act_seconds_ > act.time_limit) {
      acts_.clear();
      has_begun_ = false;
      for (scene::HandControls& controls : controls_) controls.cut = controls.coagulate = false;
    } else {
      break;
    }
  }
  scene::Input input;
  input.settings = scene_->settings;
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand) input.hands[hand] = hands_[hand].Step(dt);
  input.controls = controls_;
  StepCamera(dt);
  input.laparoscope = camera_;
  return input;
}

void TaskSurgeon::VisitState(base::StateArchive& archive) {
  archive.Field("error_scenario", error_scenario_);
  archive.Field("random", random_);
  archive.Field("hands", hands_);
  archive.Field("controls", controls_);
  archive.Field("start", start_);
  archive.Field("start_pieces", start_pieces_);
  archive.Field("camera", camera_);
  archive.Field("camera_from", camera_from_);
  archive.Field("camera_to", camera_to_);
  archive.Field("camera_time", camera_time_);
  archive.Field("camera_duration", camera_duration_);
  VisitQueue(archive, "acts", acts_);
  archive.Field("has_begun", has_begun_);
  archive.Field("act_seconds", act_seconds_);
  archive.Field("pause", pause_);
  archive.Field("fruitless_plans", fruitless_plans_);
  archive.Field("steps_seen", steps_seen_);
  archive.Field("has_finished", has_finished_);
  archive.Field("doing", doing_);
  archive.Field("goal_name", goal_name_);
}

void TaskSurgeon::Plan(const Snapshot& seen) {
  std::uint64_t steps = 0;
  for (const GoalSnapshot& goal : seen.task.goals) steps += goal.steps_done;
  fruitless_plans_ = steps > steps_seen_ ? 0 : fruitless_plans_ + 1;
  steps_seen_ = steps;
  const Task& task = *scene_->task;
  for (std::size_t g = 0; g < task.goals.size(); ++g) {
    const GoalSnapshot& now = seen.task.goals[g];
    // a goal that was begun is finished first: its thing may be in a hand
    const bool is_begun = now.steps_done > 0;
    bool is_other_begun = false;
    for (std::size_t other = 0; other < task.goals.size(); ++other) {
      const GoalSnapshot& one = seen.task.goals[other];
      is_other_begun =
          is_other_begun || (one.is_open && one.steps_done > 0 && !IsLost(seen, task.goals[other]));
    }
    if (IsLost(seen, task.goals[g])) continue;
    const bool is_open = now.is_open || (seen.task.phase == TaskPhase::kReady && task.goals[g].stage == 0);
    if (!is_open || now.is_done || (is_other_begun && !is_begun)) continue;
    if (fruitless_plans_ > kMostFruitlessPlans) break;
    goal_name_ = task.goals[g].name;
    if (AddIdleErrorScenario(seen)) return;
    if (skill_.wrong_plan > 0 && now.steps_done == 0 && BeginAtTheWrongPlace(seen, g)) return;
    PlanStep(seen, task.goals[g], now.steps_done);
    return;
  }
  has_finished_ = true;
}

/// What has left the picture and lies there is not fetched.
bool TaskSurgeon::IsLost(const Snapshot& seen, const scene::Goal& goal) const {
  // who lets the picture wander knows that a thing is there all the same
  const math::Pose X = skill_.camera_drift > 0
                           ? scene::CalcLaparoscopePose(scene_->laparoscope, scene_->laparoscope.home)
                           : seen.X_world_laparoscope;
  return std::any_of(goal.steps.begin(), goal.steps.end(), [&](const scene::Condition& step) {
    if (step.object < 0) return false;
    const ObjectSnapshot& thing = seen.objects[static_cast<std::size_t>(step.object)];
    return thing.held_by == 0 &&
           !IsInView(X, scene_->laparoscope.field_of_view, thing.X_world_object.translation);
  });
}

int TaskSurgeon::ChooseHand(const Snapshot& seen, int object, int wanted) const {
  const ObjectSnapshot& thing = seen.objects[static_cast<std::size_t>(object)];
  if (wanted != kAnyHand) return wanted;
  if (thing.held_by != 0) return (thing.held_by & 1) != 0 ? kLeft : kRight;
  const auto distance = [&](int hand) {
    return math::Distance(scene_->instruments[static_cast<std::size_t>(hand)].p_world_port,
                          thing.X_world_object.translation);
  };
  // a hand that holds something else is not free
  const auto is_free = [&](int hand) { return seen.instruments[static_cast<std::size_t>(hand)].object < 0; };
  if (is_free(kLeft) != is_free(kRight)) return is_free(kLeft) ? kLeft : kRight;
  return distance(kLeft) < distance(kRight) ? kLeft : kRight;
}

void TaskSurgeon::PlanStep(const Snapshot& seen, const scene::Goal& goal, std::uint32_t step) {
  const scene::Condition& c = goal.steps[step];
  const Task& task = *scene_->task;
  const auto region = [&]() -> const Region& {
    return task.regions[static_cast<std::size_t>(c.regions.front())];
  };
  const auto is_held = [&](int hand) {
    return ((seen.objects[static_cast<std::size_t>(c.object)].held_by >> hand) & 1) != 0;
  };
  switch (c.kind) {
    case ConditionKind::kHeld:
    case ConditionKind::kLifted: {
      const int hand = ChooseHand(seen, c.object, c.hand);
      if (!is_held(hand)) PickUp(hand, c.object, hand);
      if (c.kind == ConditionKind::kLifted) Rise(hand, c.amount + 0.002);
      break;
    }
    case ConditionKind::kHandedOver:
      // what is led along a path is passed on where it is
      PlanHandOver(seen, c.object, c.hand == kAnyHand ? ChooseHand(seen, c.object, kAnyHand) : c.hand, c.to,
                   step > 0 && goal.steps[step - 1].kind == ConditionKind::kInRegion);
      break;
    case ConditionKind::kPlaced:
      PlanPlace(seen, c.object, c.regions);
      break;
    case ConditionKind::kInRegion: {
      const int hand = ChooseHand(seen, c.object, kAnyHand);
      if (!is_held(hand)) {
        PickUp(hand, c.object, hand);
        return;
      }
      if (AddErrorScenario(seen, hand, c.object, true)) return;
      Carry(hand, c.object, region().centre, 0.4);
      break;
    }
    case ConditionKind::kTipInRegion: {
      const int hand = c.hand != kAnyHand ? c.hand : region().centre.x < 0 ? kLeft : kRight;
      HandOf(hand).SetJaw(0);
      ReachPoint(hand, region().centre);
      break;
    }
    case ConditionKind::kCameraSees:
      Look(region(), 0.5 * (c.near + std::min(c.far, c.near + 0.2)));
      break;
    case ConditionKind::kClipped:
    case ConditionKind::kDivided:
    case ConditionKind::kParted:
    case ConditionKind::kCutFree:
      PlanTissue(seen, c);
      return;
    case ConditionKind::kEvent:
      // tissue is taken where the step before has brought the tip
      if (c.event == static_cast<int>(surgery::FactKind::kGrasp) && c.hand != kAnyHand && step > 0 &&
          goal.steps[step - 1].kind == ConditionKind::kTipInRegion) {
        const int before = goal.steps[step - 1].regions.front();
        GraspTissue(seen, c.hand, task.regions[static_cast<std::size_t>(before)].centre);
        return;
      }
      Wait(0.5);
      break;
    default:  // no goal that a hand could bring about
      Wait(0.5);
      break;
  }
  Wait(c.seconds + 0.1);
}

void TaskSurgeon::PlanPlace(const Snapshot& seen, int object, const std::vector<int>& regions) {
  const ObjectSnapshot& thing = seen.objects[static_cast<std::size_t>(object)];
  const int hand = ChooseHand(seen, object, kAnyHand);
  if (thing.held_by == 0) {
    PickUp(hand, object, hand);
    return;
  }
  if (AddErrorScenario(seen, hand, object)) return;
  // the nearest place where nothing lies
  const Region* best = nullptr;
  for (const int index : regions) {
    const Region& region = scene_->task->regions[static_cast<std::size_t>(index)];
    bool is_taken = false;
    for (std::size_t i = 0; i < seen.objects.size(); ++i) {
      if (static_cast<int>(i) == object || !scene_->objects[i].Moves()) continue;
      is_taken = is_taken || region.Contains(seen.objects[i].X_world_object.translation);
    }
    const auto way = [&](const Region& r) {
      return math::Distance(r.centre, thing.X_world_object.translation);
    };
    if (!is_taken && (best == nullptr || way(region) < way(*best))) best = &region;
  }
  if (best == nullptr) return Wait(0.5);
  // out from under what the other hand holds, the way that the tool came in
  if (seen.instruments[static_cast<std::size_t>(1 - hand)].object >= 0) WithDraw(hand);
  Rise(hand, std::max(0.0, best->centre.z + kAbovePlace - thing.X_world_object.translation.z));
  Carry(hand, object, best->centre + Vec3{0, 0, kAbovePlace});
  Carry(hand, object, best->centre + Vec3{0, 0, kLetGoHeight - skill_.press}, 0.6);
  LetGo(hand);
  WithDraw(hand);
}

void TaskSurgeon::PlanHandOver(const Snapshot& seen, int object, int from, int to, bool in_place) {
  if (to == kAnyHand) to = 1 - from;
  const auto o = static_cast<std::size_t>(object);
  const ObjectSnapshot& thing = seen.objects[o];
  const bool has_from = ((thing.held_by >> from) & 1) != 0, has_to = ((thing.held_by >> to) & 1) != 0;
  if (has_to && !has_from) {  // in the wrong hand: put down where it is, and taken by the other
    Carry(to, object,
          {0, thing.X_world_object.translation.y,
           scene_->objects[o].body.X_world_body.translation.z + kLetGoHeight});
    LetGo(to);
    WithDraw(to);
    return;
  }
  if (!has_from) {
    PickUp(from, object, from);
    return;
  }
  if (AddErrorScenario(seen, from, object)) return;
  const Vec3 start = scene_->objects[o].body.X_world_body.translation;
  const Vec3 transfer{0, start.y, start.z + kTransferHeight};
  if (!has_to) {
    if (!in_place) {
      Rise(from, start.z + 0.5 * kTransferHeight - thing.X_world_object.translation.z);
      Carry(from, object, transfer);
    }
    const auto grips = scene_->objects[o].grips.size();
    PickUp(to, object, grips < 2 ? 0 : to);
  }
  Add({TaskAct::Kind::kPass, "hold with both hands"});
  Wait(0.25);
  LetGo(from);
  WithDraw(from);
}

}  // namespace trocar::agent
