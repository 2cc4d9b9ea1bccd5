// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/task.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "trocar/math/state_fields.h"

namespace trocar::scene {

bool Region::Contains(const math::Vec3& p_world) const noexcept {
  const math::Vec3 d = p_world - centre;
  if (radius > 0) return math::SquaredNorm(d) <= radius * radius;
  return std::fabs(d.x) <= half.x && std::fabs(d.y) <= half.y && std::fabs(d.z) <= half.z;
}

std::string_view ConditionName(ConditionKind kind) noexcept {
  static constexpr std::string_view kNames[] = {"held",
                                                "lifted",
                                                "handed_over",
                                                "in_region",
                                                "placed",
                                                "tip_in_region",
                                                "camera_sees",
                                                "touches",
                                                "tool_touches",
                                                "dropped",
                                                "outside",
                                                "out_of_view",
                                                "tip_out_of_view",
                                                "force_above",
                                                "event",
                                                "operation_error",
                                                "clipped",
                                                "divided",
                                                "unclipped_cut",
                                                "parted",
                                                "cut_free",
                                                "cut_off_line",
                                                "cut_area_off"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(ConditionKind::kCount));
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view PhaseName(TaskPhase phase) noexcept {
  static constexpr std::string_view kNames[] = {"none",      "ready",     "running",
                                                "completed", "time_over", "ended"};
  return kNames[static_cast<std::size_t>(phase)];
}

double CalcShownScore(const Task& task, const TaskSnapshot& now) noexcept {
  if (!(task.reference_points > 0)) return now.score;
  return std::min(now.score, 100.0) * task.best_score / 100.0;
}

double CalcIdealPathLength(const Task& task, std::size_t hand) noexcept {
  const std::vector<math::Vec3>& path = task.ideal_path[hand];
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += math::Distance(path[i - 1], path[i]);
  return length;
}

void VisitState(base::StateArchive& archive, GoalSnapshot& goal) {
  archive.Field("steps_done", goal.steps_done);
  archive.Field("is_done", goal.is_done);
  archive.Field("is_open", goal.is_open);
  archive.Field("held_seconds", goal.held_seconds);
}

void VisitState(base::StateArchive& archive, TaskError& error) {
  archive.Field("rule", error.rule);
  archive.Field("time", error.time);
  archive.Field("position", error.position);
  archive.Field("object", error.object);
  archive.Field("hand", error.hand);
}

void VisitState(base::StateArchive& archive, TaskSnapshot& task) {
  archive.Field("phase", task.phase);
  archive.Field("time", task.time);
  archive.FixedField("goals", task.goals);
  archive.FixedField("errors", task.errors);
  archive.Field("penalty", task.penalty);
  archive.Field("score", task.score);
  archive.Field("error_count", task.error_count);
  archive.Field("last_errors", task.last_errors);
}

}  // namespace trocar::scene
