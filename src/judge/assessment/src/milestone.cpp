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
  const simulation::OperationSnapshot& operation = now.operation;
  if (reached_ == Milestone::kStart && operation.critical_view.IsAchieved())
    reached_ = Milestone::kCriticalView;
  if (reached_ == Milestone::kCriticalView && operation.facts.structures_entering == 0)
    reached_ = Milestone::kDivided;
  if (reached_ == Milestone::kDivided && operation.is_gallbladder_free) reached_ = Milestone::kFree;
  if (reached_ == Milestone::kFree && operation.is_completed) reached_ = Milestone::kCompleted;
}

}  // namespace trocar::assessment
