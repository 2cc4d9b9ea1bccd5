// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/judged_attempt.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "trocar/assessment/course.h"
#include "trocar/assessment/judge_recording.h"
#include "trocar/files/task_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/host/version.h"
#include "trocar/record/replay.h"
#include "trocar/scene/scene.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/training/coach.h"
#include "trocar/training/validity.h"

namespace trocar::centre {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr const char* kDemonstration = "the demonstration";  // as session::Runner names its player

/// Keeps in the outcome for which step the attempt was made: the store's attempts know no courses.
void SetStepName(store::Attempt& attempt, const StepName& step) {
  if (step.IsSet()) attempt.outcome = record::WithCourseStep(attempt.outcome, step);
}

base::Result<std::string> ReadAsset(const char* file) {
  const auto data = host::FindDataFolder();
  if (!data.ok()) return data.error();
  return host::ReadFile(*data / "assets" / file);
}

/// What was found out about the task's metrics; nothing where it has not been studied.
std::optional<training::TaskValidity> FindValidity(const std::string& task) {
  const auto text = ReadAsset(training::kValidityFile);
  if (!text.ok()) return std::nullopt;
  const auto validity = training::ParseValidity(*text, training::kValidityFile);
  if (!validity.ok()) return std::nullopt;
  const training::TaskValidity* found = validity->FindTask(task);
  return found == nullptr ? std::nullopt : std::optional(*found);
}

std::vector<report::Advice> Coach(const training::AttemptTrace& trace,
                                  const training::AttemptMetrics& metrics,
                                  const std::optional<training::TaskValidity>& validity) {
  std::vector<report::Advice> all;
  const auto text = ReadAsset(training::kCoachRulesFile);
  if (!text.ok()) return all;
  const auto rules = training::ParseCoachRules(*text, training::kCoachRulesFile);
  if (!rules.ok()) return all;
  for (training::Advice& one :
       training::CoachAttempt(trace, metrics, *rules, validity ? &*validity : nullptr)) {
    report::Advice advice;
    advice.sentence = std::move(one.sentence);
    advice.why = std::move(one.why);
    advice.exercise = std::move(one.exercise);
    advice.practise = std::move(one.practise);
    advice.time = one.time;
    all.push_back(std::move(advice));
  }
  return all;
}

/// Ranges of experts: of the thresholds' expert set, and what the study adds.
std::vector<report::MetricReference> MakeReferences(const assessment::Proficiency* proficiency,
                                                    const std::optional<training::TaskValidity>& validity) {
  std::vector<report::MetricReference> references;
  const auto find = [&](const std::string& metric, const std::string& hand,
                        const std::string& phase) -> report::MetricReference& {
    for (report::MetricReference& one : references) {
      if (one.metric == metric && one.hand == hand && one.phase == phase) return one;
    }
    report::MetricReference added;
    added.metric = metric, added.hand = hand, added.phase = phase;
    return references.emplace_back(std::move(added));
  };
  if (validity) {
    for (const training::MeasureValidity& one : validity->measures) {
      report::MetricReference& reference = find(one.metric, one.hand, "");
      reference.separates = one.separates;
      if (one.experts > 1)
        reference.expert_mean = one.expert_mean, reference.expert_deviation = one.expert_sd;
    }
  }
  if (proficiency != nullptr) {
    for (const assessment::Norm& norm : proficiency->norms) {
      report::MetricReference& reference = find(norm.of.metric, norm.of.hand, norm.of.phase);
      reference.expert_mean = norm.mean, reference.expert_deviation = norm.deviation;
    }
  }
  return references;
}

base::Result<std::optional<assessment::Proficiency>> FindThresholds(const std::string& task,
                                                                    const std::string& level) {
  auto all = assessment::ListProficiencies();
  if (!all.ok()) return all.error();
  for (assessment::Proficiency& one : *all) {
    if (one.task == task && one.level == level) return std::optional(std::move(one));
  }
  return std::optional<assessment::Proficiency>();
}

std::int64_t NowMilliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

base::Result<store::Attempt> Describe(const record::Recording& recording, const fs::path& path,
                                      const JudgeSettings& settings) {
  auto attempt = store::DescribeAttempt(recording, path);
  if (!attempt.ok()) return attempt.error();
  attempt->task = assessment::TaskKeyOf(attempt->task);
  // a folder of a user is nobody else's business
  attempt->patient = fs::path(attempt->patient).filename().string();
  attempt->trainee = settings.person;
  SetStepName(*attempt, settings.step);
  return attempt;
}

/// Whether the file says what was computed. Of a part of an operation nothing is computed behind the step's last moment.
void SetMark(const record::Replay& replay, const record::Description& description, store::Attempt& attempt) {
  store::VerificationMark& mark = attempt.mark;
  mark.program = host::VersionText();
  mark.time_ms = NowMilliseconds();
  if (replay.IsAtEnd() && !replay.IsEndingSame()) {
    const bool is_of_this_version = record::IsOfThisProgram(description);
    mark.claim = replay.GetRecording().ending->outcome;
    mark.state = is_of_this_version ? store::Verification::kRefused : store::Verification::kUnverified;
    mark.why = is_of_this_version ? store::WhyUnverified::kOtherEnding : store::WhyUnverified::kOtherVersion;
  } else if (description.first_tick > 0) {
    mark.why = store::WhyUnverified::kSavedState;
  } else {
    mark.state = store::Verification::kVerified, mark.why = store::WhyUnverified::kNone;
  }
}

/// What is known without the states.
base::Result<JudgedAttempt> BeginJudging(const record::Recording& recording, const fs::path& path,
                                         const JudgeSettings& settings) {
  JudgedAttempt judged;
  auto attempt = Describe(recording, path, settings);
  if (!attempt.ok()) return attempt.error();
  judged.attempt = std::move(*attempt);
  judged.step = settings.step;
  judged.begin = static_cast<double>(recording.FirstTick()) * recording.description.tick_seconds;
  judged.is_demonstration = recording.description.player == kDemonstration;
  return judged;
}

base::Result<std::optional<assessment::Step>> FindStep(const StepName& name) {
  if (!name.IsSet()) return std::optional<assessment::Step>();
  const auto course = assessment::FindCourse(name.course);
  if (!course.ok()) return course.error();
  auto found = assessment::FindStep(*course, name.step);
  if (!found.ok()) return found.error();
  return std::optional(std::move(*found));
}

/// Verdict, coach and report of what was played.
base::Result<JudgedAttempt> CompleteJudging(JudgedAttempt judged, const std::optional<assessment::Step>& step,
                                            const assessment::PlayedAttempt& played,
                                            const record::Description& description, const fs::path& path,
                                            const JudgeSettings& settings) {
  const assessment::AttemptResult& result = played.result;
  std::optional<assessment::Proficiency> proficiency;
  if (step) {
    proficiency = step->proficiency;
    judged.attempt.patient = step->patient.Text();
  } else {
    auto found = FindThresholds(judged.attempt.task, judged.attempt.level);
    if (!found.ok()) return found.error();
    proficiency = std::move(*found);
  }
  judged.attempt.metrics = result.metrics.values;
  judged.attempt.is_completed = result.is_completed;
  judged.attempt.score = played.trace.outcome.score;
  if (proficiency) {
    judged.verdict = assessment::Judge(*proficiency, result);
    judged.attempt.is_passed = judged.verdict->is_passed;
  }
  if (step) judged.debriefing = judged.verdict->is_passed ? step->after_pass : step->after_fail;

  const auto validity = FindValidity(judged.attempt.task);
  const auto references = MakeReferences(proficiency ? &*proficiency : nullptr, validity);
  const auto advice = Coach(played.trace, result.metrics, validity);
  report::AttemptReportInput input;
  input.facts = report::DescribeAttempt(description, played.task_name);
  input.facts.person = settings.person;
  input.facts.recording = path.filename().string();
  input.facts.is_as_recorded = judged.attempt.mark.claim.empty();
  input.facts.best_score = played.best_score;
  input.references = references;
  input.advice = advice;
  judged.report = report::MakeAttemptReport(played.trace, result.metrics, input);
  return judged;
}

}  // namespace

base::Result<store::Attempt> DescribeRecording(const fs::path& path, const std::string& person,
                                               const StepName& step) {
  const auto recording = record::ReadRecording(path);
  if (!recording.ok()) return recording.error();
  JudgeSettings settings;
  settings.person = person, settings.step = step;
  return Describe(*recording, path, settings);
}

base::Result<JudgedAttempt> JudgeRecording(const fs::path& path, const JudgeSettings& settings,
                                           std::unique_ptr<Replaying>* going_on) {
  auto recording = record::ReadRecording(path);
  if (!recording.ok()) return recording.error();
  const record::Description description = recording->description;
  auto judged = BeginJudging(*recording, path, settings);
  if (!judged.ok()) return judged.error();
  const auto step = FindStep(settings.step);
  if (!step.ok()) return step.error();
  std::unique_ptr<Replaying> playing = going_on != nullptr ? std::move(*going_on) : nullptr;
  if (playing == nullptr) {
    auto replay = record::Replay::Open(std::move(*recording), settings.threads);
    if (!replay.ok()) return replay.error();
    using assessment::Milestone;
    assessment::AttemptFold fold(replay->GetSimulation(), *step ? (*step)->from : Milestone::kStart,
                                 *step ? (*step)->until : Milestone::kCompleted);
    playing.reset(new Replaying{std::move(*replay), std::move(fold)});
  }
  auto played =
      assessment::PlayAttempt(playing->replay, playing->fold, {settings.threads, settings.progress});
  if (!played.ok()) {
    if (played.error().code == ErrorCode::kCancelled && going_on != nullptr) *going_on = std::move(playing);
    return played.error();
  }
  SetMark(playing->replay, description, judged->attempt);
  return CompleteJudging(std::move(*judged), *step, *played, description, path, settings);
}

base::Result<JudgedAttempt> JudgePlayed(const fs::path& path, const assessment::AttemptFold& fold,
                                        const JudgeSettings& settings) {
  auto recording = record::ReadRecording(path);
  if (!recording.ok()) return recording.error();
  auto judged = BeginJudging(*recording, path, settings);
  if (!judged.ok()) return judged.error();
  const auto step = FindStep(settings.step);
  if (!step.ok()) return step.error();
  const auto played = fold.Calc();
  if (!played.ok()) return played.error();
  store::VerificationMark& mark = judged->attempt.mark;
  mark.program = host::VersionText();
  mark.time_ms = NowMilliseconds();
  mark.state = store::Verification::kRecordedHere, mark.why = store::WhyUnverified::kNone;
  return CompleteJudging(std::move(*judged), *step, *played, recording->description, path, settings);
}

StepName FindStepName(const store::Attempt& attempt) {
  return record::FindCourseStep(attempt.outcome);
}

std::string TaskNameOf(const std::string& key) {
  if (const auto tasks = files::ListTasks(); tasks.ok()) {
    for (const files::TaskEntry& task : *tasks) {
      if (task.key == key) return host::Translate(task.name);
    }
  }
  std::string words = key;
  std::replace(words.begin(), words.end(), '_', ' ');
  if (!words.empty() && words[0] >= 'a' && words[0] <= 'z')
    words[0] = static_cast<char>(words[0] - 'a' + 'A');
  return host::Translate(words);
}

}  // namespace trocar::centre
