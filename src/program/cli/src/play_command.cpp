// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "attempt_page.h"
#include "attempt_recording.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "part_folder.h"
#include "picture_size.h"
#include "play_operation.h"
#include "pseudonym_option.h"
#include "trocar/agent/surgeon.h"
#include "trocar/assessment/play_state.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"
#include "trocar/files/operation_level_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/threads.h"
#include "trocar/host/version.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/scene/task.h"
#include "trocar/session/input_sources.h"
#include "trocar/simulation/attempt_end.h"
#include "trocar/simulation/simulation.h"
#include "trocar/view/demo.h"
#include "validity_note.h"

namespace trocar::cli {

using host::PrintLine;
using host::Say;
using host::ShownNumber;
using host::Translate;

namespace {

using scene::TaskPhase;
using simulation::Snapshot;

struct PlayArguments {
  std::string surgeon, task, patient, output;
  std::string level = "normal", size = "1280x720", record, report, person;
  std::uint64_t seed = 1;
  int threads = 1;
  double most_seconds = 3600;
  assessment::PlayFiles files;
  bool is_json = false, is_list = false;
};

/// What a run came to.
struct PlayReport {
  scene::TaskSnapshot task;
  double blood_ml = 0, bile_ml = 0;
  double tick_p99_ms = 0, cut_tick_max_ms = 0;
  double seconds = 0;
  std::uint64_t hash = 0;
  bool gave_up = false;
  std::vector<scene::TaskError> errors;  // all of them, in order
};

/// Follows a run tick by tick.
class Watcher {
 public:
  explicit Watcher(const scene::Scene& scene) : scene_(scene) {}

  void See(const Snapshot& snapshot) {
    tick_ms_.push_back(1e3 * snapshot.tick_seconds);
    if (snapshot.operation.topology.version != topology_) {
      topology_ = snapshot.operation.topology.version;
      cut_tick_max_ms_ = std::max(cut_tick_max_ms_, 1e3 * snapshot.tick_seconds);
    }
    const scene::TaskSnapshot& task = snapshot.task;
    const auto ring = static_cast<std::uint64_t>(task.last_errors.size());
    const std::uint64_t oldest = task.error_count > ring ? task.error_count - ring : 0;
    for (std::uint64_t n = std::max(known_errors_, oldest); n < task.error_count; ++n)
      errors_.push_back(task.last_errors[n % ring]);
    known_errors_ = task.error_count;
  }

  PlayReport Finish(const Snapshot& last, std::uint64_t hash) {
    PlayReport report;
    report.task = last.task;
    report.blood_ml =
        kMillilitre * last.operation.flow.ledger.fluids[static_cast<int>(surgery::Fluid::kBlood)].left;
    report.bile_ml =
        kMillilitre * last.operation.flow.ledger.fluids[static_cast<int>(surgery::Fluid::kBile)].left;
    report.tick_p99_ms = base::CalcPercentile(tick_ms_, 0.99);
    report.cut_tick_max_ms = cut_tick_max_ms_;
    report.seconds = last.time;
    report.hash = hash;
    report.gave_up = !last.task.IsOver();
    report.errors = std::move(errors_);
    return report;
  }

 private:
  const scene::Scene& scene_;
  std::vector<double> tick_ms_;
  std::uint32_t topology_ = 0;
  double cut_tick_max_ms_ = 0;
  std::uint64_t known_errors_ = 0;
  std::vector<scene::TaskError> errors_;
};

nlohmann::ordered_json TaskErrorJson(const scene::Scene& scene, const scene::TaskError& error) {
  const scene::ErrorRule& rule = scene.task->errors[static_cast<std::size_t>(error.rule)];
  const auto& p = error.position;
  nlohmann::ordered_json json = {{"error", rule.name},
                                 {"about", rule.about},
                                 {"severity", surgery::NameOf(rule.severity)},
                                 {"time_s", error.time},
                                 {"at_mm", {1e3 * p.x, 1e3 * p.y, 1e3 * p.z}}};
  if (error.object >= 0) json["object"] = scene.objects[static_cast<std::size_t>(error.object)].name;
  if (error.hand >= 0) json["hand"] = error.hand == instrument::kLeft ? "left" : "right";
  return json;
}

void PrintForProgram(const scene::Scene& scene, const PlayReport& report) {
  nlohmann::ordered_json json = {{"completed", simulation::HasCompleted(report.task.phase, false)},
                                 {"critical_view", nullptr},
                                 {"critical_errors", nlohmann::ordered_json::array()},
                                 {"errors", nlohmann::ordered_json::array()}};
  for (const scene::TaskError& error : report.errors) {
    const bool is_critical =
        scene.task->errors[static_cast<std::size_t>(error.rule)].severity == surgery::Severity::kCritical;
    json[is_critical ? "critical_errors" : "errors"].push_back(TaskErrorJson(scene, error));
  }
  json.update({{"blood_ml", report.blood_ml},
               {"bile_ml", report.bile_ml},
               {"tick_p99_ms", report.tick_p99_ms},
               {"cut_tick_max_ms", report.cut_tick_max_ms},
               {"hash", base::HashText(report.hash)},
               {"score", scene::CalcShownScore(*scene.task, report.task)},
               {"best_score", scene.task->best_score},
               {"time_s", report.task.time},
               {"phase", scene::PhaseName(report.task.phase)}});
  nlohmann::ordered_json goals = nlohmann::ordered_json::array();
  for (std::size_t g = 0; g < report.task.goals.size(); ++g) {
    goals.push_back({{"goal", scene.task->goals[g].name},
                     {"done", report.task.goals[g].is_done},
                     {"steps_done", report.task.goals[g].steps_done},
                     {"steps", scene.task->goals[g].steps.size()}});
  }
  json["goals"] = std::move(goals);
  PrintJson(json);
}

std::string FormatShownScore(const scene::Task& task, const scene::TaskSnapshot& now) {
  const std::string score = ShownNumber(scene::CalcShownScore(task, now), 4);
  return task.reference_points > 0
             ? host::TranslateWith("{1} of {2}", {score, ShownNumber(task.best_score, 4)})
             : host::TranslateWith("{1} points", {score});
}

void PrintTaskResult(const scene::Scene& scene, const PlayReport& report) {
  const auto done = std::count_if(report.task.goals.begin(), report.task.goals.end(),
                                  [](const auto& goal) { return goal.is_done; });
  Say("{1}, level {2}: {3} after {4} s, {5} of {6} goals, score {7}\n",
      host::TranslateComposed(scene.task->name), Translate(scene.task->level),
      Translate(report.gave_up ? host::Mark("given up") : scene::PhaseName(report.task.phase)),
      ShownNumber(report.task.time, 4), done, report.task.goals.size(),
      FormatShownScore(*scene.task, report.task));
  for (std::size_t e = 0; e < scene.task->errors.size(); ++e) {
    if (report.task.errors[e] == 0) continue;
    const scene::ErrorRule& rule = scene.task->errors[e];
    Say("  {1} x {2}: {3} ({4}, {5} points each)\n", report.task.errors[e], rule.name, Translate(rule.about),
        Translate(surgery::NameOf(rule.severity)), ShownNumber(rule.penalty));
  }
  Say("Tick p99 {1} ms, state hash {2}\n", ShownNumber(report.tick_p99_ms, 3), base::HashText(report.hash));
  Say("Training feedback, not certified assessment.\n");
}

constexpr std::size_t kListWidth = 100;  // columns

/// A task in one line, and below it who can do it, in lines that a terminal holds.
void PrintTask(const std::string& key, const std::string& levels, const scene::Scene& scene) {
  PrintLine(key + (levels.empty() ? "" : " (" + levels + ")") + ": " + host::TranslateComposed(scene.name));
  std::string line = "   ";
  for (const agent::SurgeonEntry& entry : agent::ListSurgeons()) {
    if (!entry.suits(scene)) continue;
    const std::string name = entry.name;
    if (line.size() + 1 + name.size() > kListWidth) {
      PrintLine(line);
      line = "   ";
    }
    line += " " + name;
  }
  PrintLine(line);
}

base::Status PrintList() {
  const auto tasks = files::ListTasks();
  if (!tasks) return tasks.error();
  for (const files::TaskEntry& task : *tasks) {
    const auto scene = files::ReadTask(task.path);
    if (!scene) return scene.error();
    std::string levels;
    for (const std::string& level : task.levels) levels += (levels.empty() ? "" : ", ") + level;
    PrintTask(task.key, levels, *scene);
  }
  const auto operation = files::FindOperation(procedures::kUsualProcedure, {}, 0);
  if (!operation) return operation.error();
  const auto operation_levels = files::ListOperationLevels();
  if (!operation_levels) return operation_levels.error();
  std::string levels;
  for (const scene::OperationLevel& level : *operation_levels)
    levels += (levels.empty() ? "" : ", ") + level.key;
  if (*operation) PrintTask(procedures::kUsualProcedure, levels, **operation);
  PrintLine();
  std::vector<std::vector<std::string>> rows = {{"surgeon", "error", "about"}};
  for (const agent::SurgeonEntry& entry : agent::ListSurgeons())
    rows.push_back({entry.name, *entry.error == 0 ? "-" : entry.error, Translate(entry.about)});
  host::PrintTable(rows);
  return {};
}

/// Of an operation: at the normal level recordings and courses say nothing.
std::string LevelToKeep(const std::string& level) {
  return level == scene::kNormalLevel ? "" : level;
}

record::Description DescribePlay(const PlayArguments& arguments) {
  record::Description description = Describe(record::Description::Kind::kTask, arguments.task,
                                             arguments.patient, arguments.seed, arguments.files.who);
  description.level = arguments.level;
  return description;
}

RunReport MakeRunReport(const scene::Scene& scene, const PlayArguments& arguments) {
  report::AttemptFacts facts = report::DescribeAttempt(DescribePlay(arguments), "");
  if (!scene.task) facts.level = scene.operation ? LevelToKeep(scene.operation->level.key) : "";
  facts.person = arguments.person;
  facts.program = host::VersionText();
  facts.task_key = TaskKey(facts.task_key);
  return {arguments.report, DescribeScene(scene, std::move(facts))};
}

/// Without pictures.
base::Result<PlayReport> PlayBlind(std::shared_ptr<const scene::Scene> scene, agent::Surgeon& surgeon,
                                   const PlayArguments& arguments) {
  auto made = simulation::Simulation::Make(
      scene, {.threads = host::UseThreads(arguments.threads), .now = host::NowNanoseconds});
  if (!made) return made.error();
  simulation::Simulation simulation = std::move(*made);
  if (auto restored = GoOn(arguments.files, arguments.most_seconds, simulation, surgeon); !restored)
    return restored.error();
  auto recording = AttemptRecording::Start(arguments.record, DescribePlay(arguments), simulation);
  if (!recording.ok()) return recording.error();
  RunReport run_report = MakeRunReport(*scene, arguments);
  run_report.Start(simulation);
  Watcher watcher(*scene);
  const std::size_t goals = scene->task->goals.size();
  host::ProgressBar progress("playing", static_cast<double>(goals));
  while (!surgeon.HasFinished() && simulation.GetSnapshot().time < arguments.most_seconds) {
    const scene::Input input = surgeon.Act(simulation.GetSnapshot());
    simulation.Step(input);
    recording->Add(input, simulation);
    run_report.AfterStep(simulation, input);
    const Snapshot& now = simulation.GetSnapshot();
    watcher.See(now);
    if (now.tick % 30 != 0) continue;
    const auto done = std::count_if(now.task.goals.begin(), now.task.goals.end(),
                                    [](const auto& goal) { return goal.is_done; });
    progress.SetLabel(ShownNumber(now.time, 3) + " s, " + Translate(surgeon.Doing()));
    progress.Show(static_cast<double>(done));
  }
  progress.Finish();
  if (auto finished = recording->Finish(simulation); !finished) return finished.error();
  if (auto written = run_report.Write(); !written) return written.error();
  if (!arguments.files.save.empty()) {
    if (auto saved = assessment::SavePlay(arguments.files.save, arguments.files.who, simulation, surgeon);
        !saved)
      return saved.error();
  }
  return watcher.Finish(simulation.GetSnapshot(), simulation.Hash());
}

/// With pictures and a video.
base::Result<PlayReport> PlayForTheEye(std::shared_ptr<const scene::Scene> scene, agent::Surgeon& surgeon,
                                       const PlayArguments& arguments) {
  view::DemoOptions options;
  const auto size = ReadSize(arguments.size);
  if (!size) return size.error();
  options.width = (*size)[0], options.height = (*size)[1];
  options.threads = arguments.threads;
  PartFolder part(arguments.output);
  options.output_folder = part.Path();
  Watcher watcher(*scene);
  host::ProgressBar progress("playing", static_cast<double>(scene->task->goals.size()));
  session::SurgeonSource source(surgeon);
  options.source = &source;
  options.is_until_end = true;
  options.duration = arguments.most_seconds;
  Snapshot last;
  options.on_tick = [&](const Snapshot& now) {
    watcher.See(now);
    last = now;
    if (now.tick % 30 != 0) return;
    const auto done = std::count_if(now.task.goals.begin(), now.task.goals.end(),
                                    [](const auto& goal) { return goal.is_done; });
    progress.SetLabel(ShownNumber(now.time, 3) + " s, " + Translate(surgeon.Doing()));
    progress.Show(static_cast<double>(done));
  };
  RunReport run_report = MakeRunReport(*scene, arguments);
  run_report.Follow(options);
  const auto played = view::PlayDemonstration(scene, options);
  progress.Finish();
  if (!played) return played.error();
  if (auto written = run_report.Write(played->pictures); !written) return written.error();
  if (auto status = part.Keep(); !status) return status.error();
  return watcher.Finish(last, played->state_hash);
}

/// An operation on a patient.
base::Status PlayOne(scene::Scene scene, const PlayArguments& arguments) {
  const auto shared = std::make_shared<const scene::Scene>(std::move(scene));
  auto surgeon = agent::MakeSurgeon(arguments.surgeon, shared, arguments.seed);
  if (!surgeon) return surgeon.error();
  const auto size = ReadSize(arguments.size);
  if (!size) return size.error();
  record::Description description = DescribePlay(arguments);
  description.kind = record::Description::Kind::kOperation;
  description.level = LevelToKeep(arguments.level);
  const double seconds = std::min(arguments.most_seconds, shared->operation->level.time_limit);
  return PlayOperation(
      shared, **surgeon,
      {arguments.output, (*size)[0], (*size)[1], arguments.threads, seconds, arguments.is_json,
       arguments.files, arguments.record, std::move(description), MakeRunReport(*shared, arguments)});
}

base::Status Play(const PlayArguments& arguments, Outcome& outcome) {
  if (arguments.is_list) return PrintList();
  if (arguments.surgeon.empty() || arguments.task.empty())
    return base::Error{base::ErrorCode::kUsage, "a surgeon and --task are needed; see trocar play --list"};
  const bool has_files = !arguments.files.restore.empty() || !arguments.files.save.empty();
  if (has_files && !arguments.output.empty()) {
    return base::Error{base::ErrorCode::kUsage,
                       "--save and --restore go without pictures; leave out -o, or play from the start"};
  }
  if (!arguments.record.empty() && !arguments.output.empty()) {
    return base::Error{
        base::ErrorCode::kUsage,
        "--record goes without pictures; leave out -o, and draw the recording: trocar replay FILE -o DIR"};
  }
  if (!arguments.report.empty()) {
    // a wrong ending is told before minutes of playing
    if (const auto kind = FindReportKind(arguments.report); !kind.ok()) return kind.error();
  }
  auto operation = files::FindOperation(arguments.task, arguments.patient, arguments.seed, arguments.level);
  if (!operation.ok()) return operation.error();
  if (*operation) return PlayOne(std::move(**operation), arguments);
  const auto path = files::FindTask(arguments.task);
  if (!path) return path.error();
  auto read = files::ReadTask(*path, {arguments.level, arguments.seed, arguments.patient});
  if (!read) return read.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto surgeon = agent::MakeSurgeon(arguments.surgeon, scene, arguments.seed);
  if (!surgeon) return surgeon.error();
  const auto report = arguments.output.empty() ? PlayBlind(scene, **surgeon, arguments)
                                               : PlayForTheEye(scene, **surgeon, arguments);
  if (!report) return report.error();
  arguments.is_json ? PrintForProgram(*scene, *report) : PrintTaskResult(*scene, *report);
  outcome.has_finding = false;
  return {};
}

}  // namespace

void AddPlayCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "play");
  auto arguments = std::make_shared<PlayArguments>();
  command->add_option("surgeon", arguments->surgeon, "expert, novice, or one who errs (--list)")
      ->type_name("SURGEON");
  command->add_option("--task", arguments->task, "Name of a task (--list), or a task file (JSON)")
      ->type_name("TASK");
  command
      ->add_option("--level", arguments->level,
                   "Difficulty, one of the task's or of the operation's (--list)")
      ->type_name("LEVEL")
      ->capture_default_str();
  command->add_option("--patient", arguments->patient, "Patient folder in place of the task's own")
      ->type_name("PATIENT");
  command->add_option("--seed", arguments->seed, "Of the task's random parameters and of the hands")
      ->check(CLI::Range(0, 2147483647))
      ->type_name("K")
      ->capture_default_str();
  AddThreadsOption(*command, arguments->threads);
  command
      ->add_option("--seconds", arguments->most_seconds,
                   "Simulated time after which a surgeon is stopped, counted from the attempt's start")
      ->check(CLI::Range(1.0, 3600.0))
      ->type_name("S")
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output, "Folder for pictures and a video; none if not given")
      ->type_name("DIR");
  AddSizeOption(*command, arguments->size);
  command->add_option("--save", arguments->files.save, "Write the state and the surgeon's memory at the end")
      ->type_name("FILE");
  command
      ->add_option("--restore", arguments->files.restore,
                   "Go on where --save left off: the same task, level, patient, seed and surgeon")
      ->type_name("FILE");
  AddRecordOption(*command, arguments->record);
  command
      ->add_option("--report", arguments->report,
                   "Write what it came to: .html (one file, no network), .pdf, .csv or .json")
      ->type_name("FILE");
  AddPseudonymOption(*command, "--person", arguments->person, "Pseudonym that stands in the report");
  AddJsonFlag(*command, arguments->is_json,
              "Machine-readable; of an operation also how it ended (\"end\": completed, conversion "
              "or\nunfinished) and why it was ended early (\"bail_out\")");
  command->add_flag("--list", arguments->is_list, "Show tasks and surgeons, and do nothing");
  command->footer(
      "The same task, level, surgeon and seed give the same hash.\n"
      "Example: trocar play expert --task peg_transfer --seed 3 --json");
  command->callback([arguments, &outcome] {
    arguments->files.who = arguments->surgeon + ", seed " + std::to_string(arguments->seed);
    outcome.status = Play(*arguments, outcome);
  });
}

}  // namespace trocar::cli
