// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/milestone.h"

namespace trocar::assessment {

std::string_view NameOf(Milestone milestone) noexcept {
  constexpr std::string_view kNames[] = {"start", "critical_view", "divided", "free", "completed"};
  return kNames[static_cast<std::size_t>(milestone)];
}

std::optional<Milestone> FindMilestone(std::string_view name) noexcept {
  for (auto milestone = Milestone::kStart;;
       milestone = static_cast<Milestone>(static_cast<int>(milestone) + 1)) {
    if (NameOf(milestone) == name) return milestone;
    if (milestone == Milestone::kCompleted) return std::nullopt;
  }
}

std::string_view DescribeUntil(Milestone milestone) noexcept {
  constexpr std::string_view kTexts[] = {"from the start", "until the critical view of safety stands",
                                         "until nothing enters the gallbladder any more",
                                         "until the gallbladder is off its bed",
                                         "until the gallbladder has left in its bag"};
  return kTexts[static_cast<std::size_t>(milestone)];
}

void MilestoneWatch::See(const simulation::Snapshot& now) noexcept {
  const std::size_t count = procedure_ == nullptr ? 0 : procedure_->parts.size();
  for (auto next = static_cast<std::size_t>(reached_) + 1; next < count; ++next) {
    if (!procedure_->parts[next].is_reached(now.operation.procedure, RetrievalOf(now.operation))) return;
    reached_ = static_cast<Milestone>(next);
  }
}

surgery::RetrievalObservation RetrievalOf(const simulation::OperationSnapshot& now) noexcept {
  return {now.is_organ_free, now.is_in_bag, now.is_completed};
}

}  // namespace trocar::assessment
