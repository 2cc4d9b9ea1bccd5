// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/attempt_fold.h"

#include <utility>

#include "trocar/scene/procedure.h"
#include "trocar/scene/scene.h"
#include "trocar/training/attempt_metrics.h"

namespace trocar::assessment {
namespace {

/// Longer than any operation of the studies; what is longer is copied once [s]. Memory that nobody writes to costs nothing.
constexpr double kReservedSeconds = 3600;

}  // namespace

AttemptFold::AttemptFold(const simulation::Simulation& simulation, Milestone from, Milestone until)
    : builder_(simulation),
      watch_(scene::ProcedureOf(simulation.GetScene())),
      until_(until),
      is_part_(until != Milestone::kCompleted) {
  const scene::Scene& scene = simulation.GetScene();
  task_name_ = scene.task ? scene.task->name : scene.name;
  if (scene.task && scene.task->reference_points > 0) best_score_ = scene.task->best_score;
  builder_.Reserve(kReservedSeconds);
  builder_.Add(simulation.GetSnapshot());
  watch_.Begin(from);
}

void AttemptFold::Add(const simulation::Snapshot& now,
                      const std::array<scene::HandControls, instrument::kHandCount>& controls) {
  if (IsOver()) return;
  builder_.Add(now, controls);
  watch_.See(now);
}

base::Result<PlayedAttempt> AttemptFold::Calc() const {
  PlayedAttempt played;
  played.task_name = task_name_;
  played.best_score = best_score_;
  played.trace = builder_.Calc();
  auto metrics = training::CalcAttemptMetrics(played.trace);
  if (!metrics.ok()) return metrics.error();
  played.result.metrics = std::move(*metrics);
  if (is_part_) played.trace.outcome.is_completed = IsOver();
  played.result.is_completed = played.trace.outcome.is_completed;
  return played;
}

}  // namespace trocar::assessment
