// SPDX-License-Identifier: Apache-2.0
#include "episode.h"

#include <algorithm>
#include <cmath>

namespace trocar::environment {
namespace {

constexpr double kTaskSeconds = 300, kOperationSeconds = 1800;
constexpr double kIdleSeconds = 30;  // beyond a task's own limit, which counts from the first movement

}  // namespace

double UsualSeconds(const scene::Scene& scene) noexcept {
  if (scene.task && std::isfinite(scene.task->time_limit)) return scene.task->time_limit + kIdleSeconds;
  return scene.operation && !scene.task ? kOperationSeconds : kTaskSeconds;
}

bool IsAboutCamera(const scene::Scene& scene) noexcept {
  if (!scene.task) return false;
  return std::any_of(scene.task->goals.begin(), scene.task->goals.end(), [](const scene::Goal& goal) {
    return std::any_of(goal.steps.begin(), goal.steps.end(), [](const scene::Condition& step) {
      return step.kind == scene::ConditionKind::kCameraSees;
    });
  });
}

}  // namespace trocar::environment
