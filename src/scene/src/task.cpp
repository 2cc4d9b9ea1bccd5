// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/task.h"

#include <cmath>
#include <iterator>

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

}  // namespace trocar::scene
