// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "judgement_text.h"
#include "trocar/assessment/attempt.h"
#include "trocar/assessment/course.h"
#include "trocar/assessment/judge_recording.h"
#include "trocar/assessment/learning.h"
#include "trocar/assessment/preparation.h"
#include "trocar/files/operation_level_file.h"

namespace trocar::cli {

using host::Mark;
using host::PrintLine;
using host::Say;
using host::ShownNumber;
using host::Translate;
using host::TranslateWith;

namespace {

using assessment::Attempt;
using assessment::Course;
using assessment::Step;
using nlohmann::ordered_json;

constexpr std::size_t kWidth = 100;  // of printed words [columns]

void PrintParagraph(const std::string& text, const std::string& indent) {
  host::PrintLines(host::WrapText(Translate(text), kWidth, indent));
}

std::string WhatOf(const Step& step) {
  if (!step.IsOperation()) return TranslateWith("{1}, level {2}", {step.task, step.level});
  std::string text = step.operation;
  if (!step.patient.Text().empty()) text += TranslateWith(", patient {1}", {step.patient.Text()});
  if (step.from != assessment::Milestone::kStart)
    text += TranslateWith(", from {1}", {ShownName(NameOf(step.from))});
  return text + ", " + Translate(DescribeUntil(step.until));
}

std::string PassesOf(const Step& step) {
  std::string text = host::TranslateCount("{1} pass", "{1} passes in a row",
                                          static_cast<std::size_t>(step.consecutive_passes));
  if (step.passes > step.consecutive_passes)
    text += TranslateWith(", {1} in all", {std::to_string(step.passes)});
  return text;
}

base::Status ListCourses() {
  const auto courses = assessment::ListCourses();
  if (!courses.ok()) return courses.error();
  std::vector<std::vector<std::string>> rows = {{"course", "steps", "name"}};
  for (const Course& course : *courses)
    rows.push_back({course.key, std::to_string(course.steps.size()), Translate(course.name)});
  host::PrintTable(rows);
  return {};
}

void PrintStep(const Step& step) {
  PrintLine(step.key + ": " + Translate(step.name));
  PrintParagraph(step.goal, "  ");
  PrintLine("  " + WhatOf(step) + "; " + PassesOf(step));
  if (!step.prerequisites.empty()) {
    std::string text;
    for (const std::string& key : step.prerequisites) text += (text.empty() ? "" : ", ") + key;
    Say("  after {1}\n", text);
  }
  for (const auto& threshold : step.proficiency.thresholds) PrintLine("  " + DescribeThreshold(threshold));
}

base::Status ShowCourse(const std::string& name, const std::string& step_key) {
  const auto course = assessment::FindCourse(name);
  if (!course.ok()) return course.error();
  if (!step_key.empty()) {
    const auto step = assessment::FindStep(*course, step_key);
    if (!step.ok()) return step.error();
    PrintStep(*step);
    for (const auto& [heading, text] :
         {std::pair{Translate("Before"), &step->briefing}, std::pair{Translate("Passed"), &step->after_pass},
          std::pair{Translate("Not passed"), &step->after_fail}}) {
      PrintLine();
      PrintLine(heading);
      PrintParagraph(*text, "  ");
    }
    return {};
  }
  PrintLine(Translate(course->name));
  PrintParagraph(course->about, "");
  for (const Step& step : course->steps) {
    PrintLine();
    PrintStep(step);
  }
  return {};
}

/// ", 80 s left"; empty where that is not known
std::string TimeLeft(const assessment::PreparationProgress& now) {
  if (!now.seconds_left) return "";
  return TranslateWith(", about {1} s left", {ShownNumber(*now.seconds_left, 2)});
}

base::Status Start(const std::string& name, const std::string& step_key, const std::string& cache,
                   int threads) {
  const auto course = assessment::FindCourse(name);
  if (!course.ok()) return course.error();
  const auto step = assessment::FindStep(*course, step_key);
  if (!step.ok()) return step.error();
  assessment::PreparationSettings settings;
  settings.cache = cache;
  settings.threads = threads;
  host::ProgressBar bar("the expert operates up to this step", 1.0);
  settings.progress = [&](const assessment::PreparationProgress& now) {
    bar.SetLabel(ShownNumber(now.seconds, 3) + " s, " + Translate(now.doing) + TimeLeft(now));
    bar.Show(now.share);
    return true;
  };
  const auto prepared = assessment::PrepareStep(*step, settings);
  bar.Finish();
  if (!prepared.ok()) return prepared.error();
  PrintLine(Translate(step->name));
  PrintParagraph(step->briefing, "");
  std::string command =
      " --task " + (step->IsOperation() ? step->operation : step->task + " --level " + step->level);
  if (step->seed) command += " --seed " + std::to_string(*step->seed);
  if (!prepared->patient.empty()) command += " --patient " + prepared->patient.string();
  if (!prepared->state.empty()) {
    Say("\nThe operation stands at \"{1}\", {2} s on{3}:\n  {4}\n", NameOf(step->from),
        ShownNumber(prepared->seconds, 4),
        prepared->was_delivered ? Translate(" (came with the program)")
        : prepared->was_cached  ? Translate(" (kept from before)")
                                : std::string(),
        prepared->state);
    command += " --restore " + prepared->state.string();
  }
  Say("\nLet the scripted expert do it:\n  trocar play expert{1} --record attempt.trocar\n", command);
  Say("Judge a recording of it:\n  trocar course judge {1} {2} attempt.trocar\n", name, step_key);
  return {};
}

struct PrepareArguments {
  std::string course, output, cache;
  std::vector<std::string> levels;  ///< empty: all
  int threads = 1;
};

/// Computes the states from which the course's parts of operations go on, at every level.
base::Status Prepare(const PrepareArguments& arguments) {
  const auto course = assessment::FindCourse(arguments.course);
  if (!course.ok()) return course.error();
  auto steps = assessment::ListPreparedSteps(*course);
  if (!steps.ok()) return steps.error();
  for (const std::string& level : arguments.levels) {
    if (const auto known = files::FindOperationLevel(level); !known.ok()) return known.error();
  }
  const auto& levels = arguments.levels;
  std::erase_if(*steps, [&levels](const Step& step) {
    return !levels.empty() && std::find(levels.begin(), levels.end(), step.level) == levels.end();
  });
  if (steps->empty()) {
    Say("No step of {1} begins in the middle of an operation; there is nothing to prepare.\n", course->key);
    return {};
  }
  assessment::PreparationSettings settings;
  settings.cache = arguments.cache;
  settings.threads = arguments.threads;
  if (!arguments.output.empty()) {
    // the folder holds them all, whatever lies elsewhere
    settings.states = arguments.output;
    settings.delivered = std::filesystem::path();
  }
  host::ProgressBar bar("the expert operates up to the parts", static_cast<double>(steps->size()));
  std::vector<std::vector<std::string>> rows = {{"step", "level", "begins at", ""}};
  for (const Step& step : *steps) {
    const double before = static_cast<double>(rows.size() - 1);
    settings.progress = [&](const assessment::PreparationProgress& now) {
      bar.SetLabel(Translate(step.level) + ", " + ShownName(NameOf(step.from)) + TimeLeft(now));
      bar.Show(before + now.share);
      return true;
    };
    const auto prepared = assessment::PrepareStep(step, settings);
    if (!prepared.ok()) return prepared.error();
    rows.push_back({step.key, Translate(step.level), ShownNumber(prepared->seconds, 4) + " s",
                    prepared->was_delivered ? Translate("came with the program")
                    : prepared->was_cached  ? Translate("kept from before")
                                            : Translate("computed")});
  }
  bar.Finish();
  host::PrintTable(rows);
  return {};
}

struct JudgeArguments {
  std::string course, step, recording, attempts, cache;
  int threads = 1;
  bool is_json = false;
};

base::Status JudgeStep(const JudgeArguments& arguments, Outcome& outcome) {
  const auto course = assessment::FindCourse(arguments.course);
  if (!course.ok()) return course.error();
  const auto step = assessment::FindStep(*course, arguments.step);
  if (!step.ok()) return step.error();
  if (!arguments.attempts.empty()) {
    std::vector<Attempt> before;
    std::error_code ignored;
    if (std::filesystem::exists(arguments.attempts, ignored)) {
      auto read = assessment::ReadAttempts(arguments.attempts);
      if (!read.ok()) return read.error();
      before = std::move(*read);
    }
    const auto progress = assessment::CalcProgress(*course, before);
    for (const auto& now : progress.steps) {
      if (now.key != step->key || now.state != assessment::StepState::kLocked) continue;
      return base::Error{base::ErrorCode::kStepLocked,
                         "the step \"" + step->key + "\" is locked until \"" + now.locked_by.front() +
                             "\" is done; judge it without --attempts to practise"};
    }
  }
  auto recording = record::ReadRecording(arguments.recording);
  if (!recording.ok()) return recording.error();
  host::ProgressBar bar("replaying", 1.0);
  assessment::ReplaySettings settings;
  settings.threads = arguments.threads;
  settings.progress = [&](double share) { return bar.Show(share), true; };
  auto attempt = assessment::MakeAttempt(std::move(*recording), *course, *step, arguments.cache, settings);
  bar.Finish();
  if (!attempt.ok()) return attempt.error();
  attempt->recording = arguments.recording;
  const auto verdict = assessment::Judge(step->proficiency, attempt->result);
  if (!arguments.attempts.empty()) {
    if (const auto kept = assessment::AppendAttempt(arguments.attempts, *attempt); !kept.ok()) return kept;
  }
  outcome.has_finding = !verdict.is_passed;
  if (arguments.is_json) {
    PrintJson(VerdictJson(verdict));
    return {};
  }
  PrintLine(Translate(step->name) + ": " +
            Translate(verdict.is_passed ? Mark("PASSED") : Mark("not passed")));
  PrintVerdict(verdict);
  PrintLine();
  PrintParagraph(verdict.is_passed ? step->after_pass : step->after_fail, "");
  Say("Training feedback, not certified assessment.\n");
  return {};
}

/// Time of an attempt, for its learning curve.
const double* TimeOf(const Attempt& attempt) {
  const auto& metrics = attempt.result.metrics;
  const double* time = metrics.Find("task_time");
  return time != nullptr ? time : metrics.Find("time");
}

/// What the attempts at one step say of learning, a line each.
std::vector<std::string> DescribeLearning(const Course& course, const Step& step,
                                          const std::vector<Attempt>& all) {
  std::vector<double> times;
  std::vector<bool> failed;
  for (const Attempt& attempt : all) {
    if (!IsAttemptAt(course, step, attempt)) continue;
    failed.push_back(!assessment::Judge(step.proficiency, attempt.result).is_passed);
    if (const double* time = TimeOf(attempt); time != nullptr && attempt.result.is_completed)
      times.push_back(*time);
  }
  std::vector<std::string> lines;
  if (failed.empty()) return lines;
  if (const auto curve = assessment::FitLearningCurve(times); curve.ok()) {
    lines.push_back(
        curve->gain == 0
            ? TranslateWith("time: no learning to be seen in {1} completed attempts",
                            {std::to_string(times.size())})
            : TranslateWith("time: {1} + {2} n^-{3} s, {4} s unexplained",
                            {ShownNumber(curve->plateau, 3), ShownNumber(curve->gain, 3),
                             ShownNumber(curve->rate, 3), ShownNumber(curve->rms, 2)}) +
                  (curve->is_rate_at_bound ? Translate("; too few attempts to tell where it leads") : ""));
  } else {
    lines.push_back(TranslateWith("time: {1}", {host::TranslateComposed(curve.error().message)}));
  }
  if (const auto trend = assessment::CalcTrend(times, assessment::Better::kLower); trend.ok()) {
    const char* const words[] = {Mark("no trend"), Mark("getting faster"), Mark("getting slower")};
    lines.push_back(TranslateWith("trend: {1}, {2} s an attempt (p = {3})",
                                  {Translate(words[static_cast<int>(trend->verdict)]),
                                   ShownNumber(trend->slope, 2), ShownNumber(trend->probability, 2)}));
  }
  if (const auto cusum = assessment::CalcCusum(failed); cusum.ok()) {
    const char* const words[] = {Mark("undecided"), Mark("the failure rate is acceptable"),
                                 Mark("the failure rate is too high")};
    lines.push_back(
        TranslateWith("CUSUM: {1} between {2} and {3}: {4}",
                      {ShownNumber(cusum->values.back(), 3), ShownNumber(cusum->h0, 3),
                       ShownNumber(cusum->h1, 3), Translate(words[static_cast<int>(cusum->verdict)])}));
  }
  return lines;
}

struct ProgressArguments {
  std::string course, attempts, started, today;
  bool is_json = false;
};

std::string Today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  localtime_r(&now, &parts);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
  return text;
}

base::Result<assessment::CourseDates> ReadDates(const ProgressArguments& arguments) {
  assessment::CourseDates dates;
  const auto read = [](const std::string& text, std::optional<std::chrono::sys_days>& day) {
    if (text.empty()) return true;
    day = assessment::ParseDay(text);
    return day.has_value();
  };
  if (!read(arguments.started, dates.started) ||
      !read(arguments.today.empty() ? Today() : arguments.today, dates.today))
    return base::Error{base::ErrorCode::kUsage, "a day is written like 2026-11-25"};
  return dates;
}

base::Status ShowProgress(const ProgressArguments& arguments) {
  const auto course = assessment::FindCourse(arguments.course);
  if (!course.ok()) return course.error();
  const auto attempts = assessment::ReadAttempts(arguments.attempts);
  if (!attempts.ok()) return attempts.error();
  const auto dates = ReadDates(arguments);
  if (!dates.ok()) return dates.error();
  const auto progress = assessment::CalcProgress(*course, *attempts, *dates);
  if (arguments.is_json) {
    ordered_json json = {
        {"course", course->key},
        {"done", progress.IsDone()},
        {"next", progress.next ? ordered_json(progress.steps[*progress.next].key) : ordered_json()},
        {"verified", false},  // it counts what the file says
        {"steps", ordered_json::array()}};
    for (const auto& now : progress.steps) {
      json["steps"].push_back(
          {{"step", now.key},
           {"state", NameOf(now.state)},
           {"attempts", now.attempts},
           {"passes", now.passes},
           {"longest_run", now.longest_run},
           {"locked_by", now.locked_by},
           {"due", now.due ? ordered_json(assessment::FormatDay(*now.due)) : ordered_json()},
           {"overdue", now.is_overdue}});
    }
    PrintJson(json);
    return {};
  }
  std::vector<std::vector<std::string>> rows = {{"step", "state", "attempts", "passed", "in a row", "due"}};
  for (std::size_t i = 0; i < progress.steps.size(); ++i) {
    const auto& now = progress.steps[i];
    const Step& step = course->steps[i];
    const auto of = [](int done, int all) {
      return TranslateWith("{1} of {2}", {std::to_string(done), std::to_string(all)});
    };
    rows.push_back(
        {now.key, host::TranslateIn("step", NameOf(now.state)), std::to_string(now.attempts),
         of(now.passes, step.passes), of(now.longest_run, step.consecutive_passes),
         now.due ? assessment::FormatDay(*now.due) + (now.is_overdue ? Translate(", overdue") : "") : "-"});
  }
  host::PrintTable(rows);
  for (const Step& step : course->steps) {
    const auto lines = DescribeLearning(*course, step, *attempts);
    if (lines.empty()) continue;
    PrintLine();
    PrintLine(Translate(step.name));
    for (const std::string& line : lines) PrintLine("  " + line);
  }
  if (progress.next) {
    Say("\nNext: {1}\n", Translate(course->steps[*progress.next].name));
  } else {
    Say("\nThe course is done.\n");
  }
  Say("The attempts are as their file says, and not verified here.\n");
  return {};
}

void AddStart(CLI::App& course, Outcome& outcome) {
  CLI::App* command = course.add_subcommand("start",
                                            "Make a step ready: its patient, and the moment of the operation "
                                            "from which it goes on; then its briefing");
  auto name = std::make_shared<std::string>(), step = std::make_shared<std::string>(),
       cache = std::make_shared<std::string>();
  auto threads = std::make_shared<int>(1);
  command->add_option("course", *name, "Course (trocar course list), or its file")
      ->required()
      ->type_name("COURSE");
  command->add_option("step", *step, "Key of the step")->required()->type_name("STEP");
  AddCacheOption(*command, *cache, "Folder for what is made; the user's cache folder if not given");
  AddThreadsOption(*command, *threads);
  command->footer(
      "The first time the scripted expert operates up to the step, which takes minutes, unless its state "
      "came "
      "with the program; then the state is kept.\n"
      "Example: trocar course start cholecystectomy bed");
  command->callback([=, &outcome] { outcome.status = Start(*name, *step, *cache, *threads); });
}

void AddPrepare(CLI::App& course, Outcome& outcome) {
  CLI::App* command = course.add_subcommand(
      "prepare",
      "Let the scripted expert operate up to every part of a course, at every level, so that nobody waits");
  auto a = std::make_shared<PrepareArguments>();
  command->add_option("course", a->course, "Course (trocar course list), or its file")
      ->required()
      ->type_name("COURSE");
  command->add_option("-o,--output", a->output, "Folder for all the states; the user's cache if not given")
      ->type_name("DIR");
  command->add_option("--level", a->levels, "Only of this level; may be given again; all if not given")
      ->type_name("LEVEL")
      ->allow_extra_args(false);
  AddCacheOption(*command, a->cache, "Folder for what is made; the user's cache folder if not given");
  AddThreadsOption(*command, a->threads);
  command->footer(
      "It takes minutes for each level. States that are there already are kept. Packages are made with it.\n"
      "Example: trocar course prepare cholecystectomy");
  command->callback([a, &outcome] { outcome.status = Prepare(*a); });
}

void AddJudge(CLI::App& course, Outcome& outcome) {
  CLI::App* command = course.add_subcommand(
      "judge",
      "Judge a recording by a step's thresholds, and say what comes after it; exit status 1 if not passed");
  auto a = std::make_shared<JudgeArguments>();
  command->add_option("course", a->course, "Course, or its file")->required()->type_name("COURSE");
  command->add_option("step", a->step, "Key of the step")->required()->type_name("STEP");
  command->add_option("recording", a->recording, "Recording of the attempt")->required()->type_name("FILE");
  command->add_option("--attempts", a->attempts, "Add the attempt to this file, for trocar course progress")
      ->type_name("FILE.json");
  AddCacheOption(*command, a->cache, "Folder for what is made; the user's cache folder if not given");
  AddThreadsOption(*command, a->threads);
  AddJsonFlag(*command, a->is_json);
  command->footer(
      "Example: trocar course judge basic-skills peg_transfer attempt.trocar --attempts mine.json");
  command->callback([a, &outcome] { outcome.status = JudgeStep(*a, outcome); });
}

void AddProgress(CLI::App& course, Outcome& outcome) {
  CLI::App* command = course.add_subcommand(
      "progress", "Say which steps are done, open or locked, what is next and due, and how somebody learns");
  auto a = std::make_shared<ProgressArguments>();
  command->add_option("course", a->course, "Course, or its file")->required()->type_name("COURSE");
  command->add_option("--attempts", a->attempts, "File that trocar course judge --attempts wrote")
      ->required()
      ->type_name("FILE.json");
  command->add_option("--started", a->started, "Day on which the course began, for what is due")
      ->type_name("DAY");
  command->add_option("--today", a->today, "In place of the computer's day")->type_name("DAY");
  AddJsonFlag(*command, a->is_json);
  command->footer("Example: trocar course progress basic-skills --attempts mine.json --started 2026-11-02");
  command->callback([a, &outcome] { outcome.status = ShowProgress(*a); });
}

}  // namespace

void AddCourseCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "course");
  command->require_subcommand(1);
  CLI::App* list = command->add_subcommand("list", "List the courses that are delivered");
  list->callback([&outcome] { outcome.status = ListCourses(); });
  CLI::App* show = command->add_subcommand("show", "Print a course, or one of its steps with all its words");
  auto name = std::make_shared<std::string>(), step = std::make_shared<std::string>();
  show->add_option("course", *name, "Course, or its file")->required()->type_name("COURSE");
  show->add_option("step", *step, "Key of a step")->type_name("STEP");
  show->callback([=, &outcome] { outcome.status = ShowCourse(*name, *step); });
  CLI::App* check =
      command->add_subcommand("check", "Say whether a course can be used, and if not, where and why");
  auto file = std::make_shared<std::string>();
  check->add_option("file", *file, "Course file (JSON)")->required()->type_name("FILE");
  check->callback([=, &outcome] {
    const auto course = assessment::ReadCourse(*file);
    outcome.status = course.ok() ? base::Status() : base::Status(course.error());
    if (!course.ok()) return;
    Say("{1}: {2} steps, usable\n", file->c_str(), course->steps.size());
    for (const Step& one : course->steps) {
      if (one.proficiency.thresholds.empty())
        Say("  {1} has no thresholds: whoever completes it passes\n", one.key);
    }
  });
  AddStart(*command, outcome);
  AddPrepare(*command, outcome);
  AddJudge(*command, outcome);
  AddProgress(*command, outcome);
  command->footer("Example: trocar course show basic-skills");
}

}  // namespace trocar::cli
