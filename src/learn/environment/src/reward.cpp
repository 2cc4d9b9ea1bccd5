// SPDX-License-Identifier: Apache-2.0
#include "reward.h"

#include <algorithm>
#include <limits>

#include "trocar/scene/procedure.h"
#include "trocar/simulation/attempt_end.h"

namespace trocar::environment {
namespace {

using math::Vec3;
using scene::ConditionKind;
using simulation::Snapshot;

constexpr double kMillilitre = 1e6;  // per m^3

/// From the nearest tip that may do it to where a thing is taken.
double DistanceToThing(const scene::Scene& scene, const Snapshot& now, const scene::Condition& condition) {
  const auto index = static_cast<std::size_t>(condition.object);
  const math::Pose& X = now.objects[index].X_world_object;
  double nearest = std::numeric_limits<double>::infinity();
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    if (condition.hand != scene::kAnyHand && condition.hand != hand) continue;
    const Vec3& tip = now.instruments[hand].X_world_tool.translation;
    nearest = std::min(nearest, math::Norm(X.translation - tip));
    for (const scene::ObjectGrip& grip : scene.objects[index].grips)
      nearest = std::min(nearest, math::Norm(X * grip.point - tip));
  }
  return nearest;
}

double DistanceToRegions(const scene::Scene& scene, const scene::Condition& condition, const Vec3& from) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const int region : condition.regions)
    nearest =
        std::min(nearest, math::Norm(scene.task->regions[static_cast<std::size_t>(region)].centre - from));
  return nearest;
}

/// How far what a step wants is; 0 where it is about nothing that has a place.
double CalcDistance(const scene::Scene& scene, const Snapshot& now, const scene::Condition& condition) {
  switch (condition.kind) {
    case ConditionKind::kHeld:
    case ConditionKind::kLifted:
    case ConditionKind::kHandedOver:
    case ConditionKind::kToolTouches:
      return condition.object < 0 ? 0.0 : DistanceToThing(scene, now, condition);
    case ConditionKind::kInRegion:
    case ConditionKind::kPlaced: {
      if (condition.object < 0 || condition.regions.empty()) return 0;
      const scene::ObjectSnapshot& object = now.objects[static_cast<std::size_t>(condition.object)];
      const double way = DistanceToRegions(scene, condition, object.X_world_object.translation);
      return object.held_by != 0 ? way : way + DistanceToThing(scene, now, condition);
    }
    case ConditionKind::kTipInRegion: {
      double nearest = std::numeric_limits<double>::infinity();
      for (int hand = 0; hand < instrument::kHandCount; ++hand) {
        if (condition.hand != scene::kAnyHand && condition.hand != hand) continue;
        nearest = std::min(
            nearest, DistanceToRegions(scene, condition, now.instruments[hand].X_world_tool.translation));
      }
      return condition.regions.empty() ? 0 : nearest;
    }
    default:
      return 0;
  }
}

void StandInTask(const scene::Scene& scene, const Snapshot& now, Standing& standing) {
  const scene::Task& task = *scene.task;
  std::size_t goals = 0, steps = 0, all_steps = 0;
  for (std::size_t i = 0; i < task.goals.size(); ++i) {
    const scene::GoalSnapshot& goal = now.task.goals[i];
    const std::size_t count = task.goals[i].steps.size();
    all_steps += count;
    goals += goal.is_done;
    steps += goal.is_done ? count : goal.steps_done;
    if (standing.goal >= 0 || goal.is_done || !goal.is_open || goal.steps_done >= count) continue;
    standing.goal = static_cast<int>(i);
    standing.step = static_cast<int>(goal.steps_done);
    standing.distance = CalcDistance(scene, now, task.goals[i].steps[goal.steps_done]);
  }
  standing.goals = static_cast<double>(goals) / static_cast<double>(task.goals.size());
  standing.steps = static_cast<double>(steps) / static_cast<double>(std::max<std::size_t>(all_steps, 1));
  for (std::size_t i = 0; i < task.errors.size(); ++i) {
    auto& count =
        task.errors[i].severity == surgery::Severity::kCritical ? standing.critical_errors : standing.errors;
    count += now.task.errors[i];
  }
}

}  // namespace

Standing CalcStanding(const simulation::Simulation& simulation) {
  const scene::Scene& scene = simulation.GetScene();
  const Snapshot& now = simulation.GetSnapshot();
  Standing standing;
  standing.is_completed = simulation::HasCompleted(now);
  if (scene.task) StandInTask(scene, now, standing);
  // a task's tissue has neither triangle nor bed: there these are whole from the first tick on
  if (scene.operation && scene.HasPatient()) {
    const simulation::OperationSnapshot& operation = now.operation;
    if (!scene.task) {
      standing.critical_errors = operation.critical_errors;
      standing.errors = operation.errors - operation.critical_errors;
    }
    const scene::Procedure* procedure = scene::ProcedureOf(scene);
    standing.cleared = scene::MeasureOf(procedure, operation.procedure, "cleared");
    standing.detached = scene::MeasureOf(procedure, operation.procedure, "detached");
    standing.critical_view = operation.procedure.view.Sum();
  }
  standing.blood = now.operation.flow.ledger.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].left;
  return standing;
}

void RewardMeter::Begin(const simulation::Simulation& simulation) {
  before_ = CalcStanding(simulation);
  const Snapshot& now = simulation.GetSnapshot();
  for (int hand = 0; hand < instrument::kHandCount; ++hand)
    tips_[hand] = now.instruments[hand].X_world_tool.translation;
  force_ = path_ = time_ = 0;
}

void RewardMeter::AfterTick(const simulation::Simulation& simulation) noexcept {
  const Snapshot& now = simulation.GetSnapshot();
  const double dt = simulation.GetScene().tick_seconds;
  time_ += dt;
  for (int hand = 0; hand < instrument::kHandCount; ++hand) {
    const Vec3& tip = now.instruments[hand].X_world_tool.translation;
    force_ += dt * math::Norm(now.instruments[hand].force);
    path_ += math::Norm(tip - tips_[hand]);
    tips_[hand] = tip;
  }
}

Features RewardMeter::End(const simulation::Simulation& simulation) {
  const Standing now = CalcStanding(simulation);
  Features features{};
  const auto set = [&](Feature feature, double value) {
    features[static_cast<std::size_t>(feature)] = value;
  };
  set(Feature::kGoal, now.goals - before_.goals);
  set(Feature::kStep, now.steps - before_.steps);
  // of the same step: another step's distance is measured to something else
  if (now.goal == before_.goal && now.step == before_.step)
    set(Feature::kApproach, before_.distance - now.distance);
  set(Feature::kCompleted, now.is_completed && !before_.is_completed);
  set(Feature::kError, static_cast<double>(now.errors) - static_cast<double>(before_.errors));
  set(Feature::kCriticalError,
      static_cast<double>(now.critical_errors) - static_cast<double>(before_.critical_errors));
  set(Feature::kForce, force_);
  set(Feature::kPath, path_);
  set(Feature::kTime, time_);
  set(Feature::kCleared, now.cleared - before_.cleared);
  set(Feature::kDetached, now.detached - before_.detached);
  set(Feature::kCriticalView, now.critical_view - before_.critical_view);
  set(Feature::kBlood, kMillilitre * (now.blood - before_.blood));
  return features;
}

}  // namespace trocar::environment
