// SPDX-License-Identifier: Apache-2.0
/// \file milestone.h  Moments of an operation between which a part of it is trained: rows of Procedure::parts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "trocar/scene/procedure.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::assessment {

enum class Milestone : std::uint8_t {
  kStart,         ///< "start": the first tick
  kCriticalView,  ///< "critical_view": the critical view of safety stands, and has been seen from front and behind
  kDivided,       ///< "divided": after that view, nothing enters the organ any more
  kFree,          ///< "free": the organ hangs on nothing
  kCompleted  ///< "completed": it has left the abdomen in its bag
};
std::string_view NameOf(Milestone milestone) noexcept;
std::optional<Milestone> FindMilestone(std::string_view name) noexcept;
/// For a surgeon: "until the critical view of safety"
std::string_view DescribeUntil(Milestone milestone) noexcept;

/// How far what is taken out is on its way.
surgery::RetrievalObservation RetrievalOf(const simulation::OperationSnapshot& now) noexcept;

/// Follows an operation tick by tick. Milestones are the procedure's parts (scene::Procedure::parts), reached in their order and never
/// taken back.
class MilestoneWatch {
 public:
  /// \param procedure  of the scene; null: nothing but the start is reached
  explicit MilestoneWatch(const scene::Procedure* procedure) noexcept : procedure_(procedure) {}
  void See(const simulation::Snapshot& now) noexcept;
  /// Of an operation that goes on from a state in which a milestone had been reached.
  void Begin(Milestone from) noexcept { reached_ = from; }
  Milestone Reached() const noexcept { return reached_; }
  bool HasReached(Milestone milestone) const noexcept { return reached_ >= milestone; }

 private:
  const scene::Procedure* procedure_;
  Milestone reached_ = Milestone::kStart;
};

}  // namespace trocar::assessment
