// SPDX-License-Identifier: Apache-2.0
/// \file operation_part.h  Parts of an operation as tasks of their own: where they begin, and when an attempt at one is over.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/assessment/milestone.h"
#include "trocar/centre/course_page.h"
#include "trocar/presenter/options.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/simulation/simulation.h"

namespace trocar::presenter {

/// The operation that is delivered.
inline constexpr const char* kOperationTask = procedures::kUsualProcedure;

/// A part is a step of the delivered course of that operation, on any patient and at any level.
struct OperationPart {
  std::string key;   ///< "critical-view"
  std::string name;  ///< "The critical view of safety"
  std::string goal;  ///< one sentence
  assessment::Milestone from = assessment::Milestone::kStart, until = assessment::Milestone::kCompleted;
};
/// In the order of the operation. \return the course's error
base::Result<std::vector<OperationPart>> ListOperationParts();

/// Told what is done, and how much of it [-]; false gives up.
using PartProgress = std::function<bool(const std::string& doing, double share)>;
/// Makes what a part needs before it can begin: the scripted expert operates on the chosen patient up to there, unless that was
/// delivered or lies in the cache.
/// \param options  with operation.part
/// \return kUnknownName of a part, kPreparationFailed where the expert does not come so far, kCancelled
base::Result<centre::Start> PreparePart(const Options& options, const PartProgress& progress);

/// An operation's level as recordings and the store have it: nothing at the normal one.
std::string KeepLevel(const std::string& level);

/// Says when an attempt at an operation is over.
class OperationEnd {
 public:
  enum class Reason : std::uint8_t { kNone, kCompleted, kPartDone, kTimeOver };

  /// \param now  where the attempt begins
  void Begin(const scene::Scene& scene, assessment::Milestone from, assessment::Milestone until,
             const simulation::Snapshot& now) noexcept;
  /// Tick by tick, or as often as pictures are drawn. \return the reason for as long as it holds
  Reason See(const simulation::Snapshot& now) noexcept;
  assessment::Milestone Reached() const noexcept { return watch_.Reached(); }
  /// [s], infinite without a limit
  double TimeLimit() const noexcept { return time_limit_; }
  /// Since the attempt began [s].
  double Elapsed(const simulation::Snapshot& now) const noexcept { return now.time - begin_; }

 private:
  const scene::Procedure* procedure_ = nullptr;
  assessment::MilestoneWatch watch_{nullptr};
  assessment::Milestone from_ = assessment::Milestone::kStart, until_ = assessment::Milestone::kCompleted;
  double begin_ = 0, last_ = 0, time_limit_ = 0;  // [s]
};
/// For a person: "The part is done.", "The time is over."
std::string Describe(OperationEnd::Reason reason);

}  // namespace trocar::presenter
