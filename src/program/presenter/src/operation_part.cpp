// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/operation_part.h"

#include <limits>
#include <thread>
#include <utility>

#include "trocar/assessment/course.h"
#include "trocar/assessment/preparation.h"
#include "trocar/host/translate.h"

namespace trocar::presenter {
namespace {

using assessment::Milestone;

bool IsPart(const assessment::Step& step) {
  const bool is_whole = step.from == Milestone::kStart && step.until == Milestone::kCompleted;
  return step.operation == kOperationTask && !is_whole && step.patient.Text().empty();
}

}  // namespace

base::Result<std::vector<OperationPart>> ListOperationParts() {
  const auto course = assessment::FindCourse(kOperationTask);
  if (!course.ok()) return course.error();
  std::vector<OperationPart> parts;
  for (const assessment::Step& step : course->steps) {
    if (IsPart(step)) parts.push_back({step.key, step.name, step.goal, step.from, step.until});
  }
  return parts;
}

base::Result<centre::Start> PreparePart(const Options& options, const PartProgress& progress) {
  const auto course = assessment::FindCourse(kOperationTask);
  if (!course.ok()) return course.error();
  auto step = assessment::FindStep(*course, options.operation.part);
  if (!step.ok()) return step.error();
  step->level = KeepLevel(options.level);
  step->patient = {};
  step->patient.folder = options.operation.patient;
  assessment::PreparationSettings settings;
  settings.threads =
      options.threads > 0 ? options.threads : ChooseThreads(std::thread::hardware_concurrency());
  settings.progress = [&progress](const assessment::PreparationProgress& now) {
    return !progress || progress(host::TranslateWith(
                                     "The expert brings the operation to where this part begins: {1}. {2}",
                                     {centre::DescribePreparation(now), host::TranslateComposed(now.doing)}),
                                 now.share);
  };
  const auto prepared = assessment::PrepareStep(*step, settings);
  if (!prepared.ok()) return prepared.error();
  centre::Start start;
  start.description.kind = record::Description::Kind::kOperation;
  start.description.name = step->operation;
  start.description.level = step->level;
  start.description.patient = prepared->patient.string();
  // the expert who came so far operated on the scene of this seed
  start.description.seed = settings.surgeon_seed;
  start.state = prepared->state;
  start.state_surgeon = prepared->surgeon;
  start.title = step->name;
  start.from = step->from;
  start.until = step->until;
  return start;
}

std::string KeepLevel(const std::string& level) {
  return level == scene::kNormalLevel ? "" : level;
}

void OperationEnd::Begin(const scene::Scene& scene, Milestone from, Milestone until,
                         const simulation::Snapshot& now) noexcept {
  from_ = from;
  until_ = until;
  begin_ = last_ = now.time;
  procedure_ = scene::ProcedureOf(scene);
  watch_ = assessment::MilestoneWatch(procedure_);
  watch_.Begin(from);
  const bool is_whole = from == Milestone::kStart && until == Milestone::kCompleted;
  time_limit_ = std::numeric_limits<double>::infinity();
  if (scene.operation)
    time_limit_ = is_whole ? scene.operation->level.time_limit : scene.operation->level.part_time_limit;
}

OperationEnd::Reason OperationEnd::See(const simulation::Snapshot& now) noexcept {
  if (now.time < last_) {
    // begun anew
    begin_ = now.time;
    watch_ = assessment::MilestoneWatch(procedure_);
    watch_.Begin(from_);
  }
  last_ = now.time;
  watch_.See(now);
  if (now.operation.is_completed) return Reason::kCompleted;
  if (until_ != Milestone::kCompleted && watch_.HasReached(until_)) return Reason::kPartDone;
  return Elapsed(now) >= time_limit_ ? Reason::kTimeOver : Reason::kNone;
}

std::string Describe(OperationEnd::Reason reason) {
  switch (reason) {
    case OperationEnd::Reason::kNone:
      return "";
    case OperationEnd::Reason::kCompleted:
      return host::Translate("The operation is completed. Reset begins another.");
    case OperationEnd::Reason::kPartDone:
      return host::Translate("This part is done. Reset begins it again.");
    case OperationEnd::Reason::kTimeOver:
      return host::Translate("The time is over. Reset begins another attempt.");
  }
  return "";
}

}  // namespace trocar::presenter
