// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/judge_recording.h"

#include <algorithm>
#include <utility>

#include "trocar/assessment/preparation.h"
#include "trocar/record/replay.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using record::Recording;
using record::Replay;

constexpr std::uint64_t kProgressTicks = 30;  // between two calls

Attempt Describe(const record::Description& description) {
  Attempt attempt;
  attempt.task = TaskKeyOf(description.name);
  attempt.level = description.level;
  attempt.patient = description.patient;
  attempt.seed = description.seed;
  attempt.started = description.started;
  return attempt;
}

/// Whether an operation stands where a part of it begins: that moment and the one before it have come, and no later one.
bool StandsAt(Milestone milestone, const simulation::Simulation& simulation) {
  const auto result = simulation.GetOperationResult();
  const scene::Procedure* procedure = scene::ProcedureOf(simulation.GetScene());
  const auto part = static_cast<std::size_t>(milestone);
  if (!result || procedure == nullptr || part >= procedure->parts.size())
    return milestone == Milestone::kStart;
  if (milestone == Milestone::kStart) return simulation.GetSnapshot().tick == 0;
  const simulation::OperationSnapshot& operation = simulation.GetSnapshot().operation;
  scene::ProcedureSnapshot now = operation.procedure;
  // a view that was had once counts, also where it is no more to be had
  if (result->procedure.was_view_achieved) {
    std::fill(now.view.criteria.begin(), now.view.criteria.end(), scene::ViewScore::kWhole);
    std::fill(now.view.sights.begin(), now.view.sights.end(), std::uint8_t{1});
  }
  const auto is_reached = [&](std::size_t i) {
    return procedure->parts[i].is_reached(now, RetrievalOf(operation));
  };
  return is_reached(part - 1) && is_reached(part) &&
         (part + 1 == procedure->parts.size() || !is_reached(part + 1));
}

base::Result<Attempt> Complete(Attempt attempt, Replay& replay, const ReplaySettings& settings) {
  auto played = PlayAttempt(replay, attempt.from, attempt.until, settings);
  if (!played.ok()) return played.error();
  attempt.result = std::move(played->result);
  attempt.score = played->trace.outcome.score;
  return attempt;
}

}  // namespace

std::string TaskKeyOf(const std::string& name) {
  return name.ends_with(".json") ? fs::path(name).stem().string() : name;
}

base::Result<PlayedAttempt> PlayAttempt(Replay& replay, Milestone from, Milestone until,
                                        const ReplaySettings& settings) {
  AttemptFold fold(replay.GetSimulation(), from, until);
  return PlayAttempt(replay, fold, settings);
}

base::Result<PlayedAttempt> PlayAttempt(Replay& replay, AttemptFold& fold, const ReplaySettings& settings) {
  const Recording& recording = replay.GetRecording();
  const auto count = static_cast<double>(std::max<std::size_t>(1, recording.inputs.size()));
  while (!replay.IsAtEnd() && !fold.IsOver()) {
    const std::uint64_t done = replay.Tick() - recording.FirstTick();
    replay.Step();
    fold.Add(replay.GetSimulation().GetSnapshot(), recording.inputs[done].controls);
    if (settings.progress && done % kProgressTicks == 0 &&
        !settings.progress(static_cast<double>(done) / count)) {
      return Error{ErrorCode::kCancelled,
                   "the recording was not computed to its end, so nothing is judged; begin again"};
    }
  }
  if (replay.GetDivergence()) {
    return Error{
        ErrorCode::kRecordingInvalid,
        "the recording does not replay to the states that were recorded, so there is nothing to judge; "
        "trocar replay --verify says where it differs"};
  }
  return fold.Calc();
}

base::Result<Attempt> MakeAttempt(Recording recording, const ReplaySettings& settings) {
  Attempt attempt = Describe(recording.description);
  auto replay = Replay::Open(std::move(recording), settings.threads);
  if (!replay.ok()) return replay.error();
  return Complete(std::move(attempt), *replay, settings);
}

base::Result<Attempt> MakeAttempt(Recording recording, const Course& course, const Step& step,
                                  const fs::path& cache, const ReplaySettings& settings) {
  Attempt attempt = Describe(recording.description);
  attempt.course = course.key;
  attempt.step = step.key;
  attempt.from = step.from;
  attempt.until = step.until;
  const auto refuse = [&](const std::string& why) {
    return Error{ErrorCode::kCourseInvalid,
                 "the recording does not fit the step \"" + step.key + "\": " + why};
  };
  const std::string& wanted = step.IsOperation() ? step.operation : step.task;
  if (attempt.task != wanted)
    return refuse("it is of \"" + attempt.task + "\", and the step is of \"" + wanted + "\"");
  if (attempt.level != step.level)
    return refuse("its level is \"" + attempt.level + "\", and the step's is \"" + step.level + "\"");
  if (step.seed && *step.seed != attempt.seed)
    return refuse("its seed is " + std::to_string(attempt.seed) + ", and the step's is " +
                  std::to_string(*step.seed));
  if (step.IsOperation()) {
    auto patient = PreparePatient(step.patient, cache);
    if (!patient.ok()) return patient.error();
    recording.description.patient = patient->string();
    attempt.patient = step.patient.Text();
  }
  auto replay = Replay::Open(std::move(recording), settings.threads);
  if (!replay.ok()) {
    if (step.IsOperation() && replay.error().code == ErrorCode::kRecordingInvalid)
      return refuse(
          "it is of another patient than the step's, or of another version of the program; trocar course "
          "start makes the step's patient");
    return replay.error();
  }
  if (step.IsOperation() && !StandsAt(step.from, replay->GetSimulation())) {
    return refuse("it does not begin at \"" + std::string(NameOf(step.from)) +
                  "\"; trocar course start prepares that moment");
  }
  return Complete(std::move(attempt), *replay, settings);
}

}  // namespace trocar::assessment
