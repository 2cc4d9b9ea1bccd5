// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/milestone.h"

#include "trocar/procedures/find_procedure.h"

namespace trocar::assessment {

namespace {

const scene::PartRow& PartOf(Milestone milestone) {
  static const scene::Procedure& procedure = *procedures::FindProcedure(procedures::kUsualProcedure);
  return procedure.parts[static_cast<std::size_t>(milestone)];
}

}  // namespace

std::string_view NameOf(Milestone milestone) noexcept {
  return PartOf(milestone).name;
}

std::optional<Milestone> FindMilestone(std::string_view name) noexcept {
  for (auto milestone = Milestone::kStart;;
       milestone = static_cast<Milestone>(static_cast<int>(milestone) + 1)) {
    if (NameOf(milestone) == name) return milestone;
    if (milestone == Milestone::kCompleted) return std::nullopt;
  }
}

std::string_view DescribeUntil(Milestone milestone) noexcept {
  return PartOf(milestone).until;
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
