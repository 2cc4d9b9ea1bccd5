// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <utility>

#include "attempt_recording.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/agent/surgeon.h"
#include "trocar/assessment/exam.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/threads.h"
#include "trocar/record/recording.h"

namespace trocar::cli {

using host::Say;

namespace {

using assessment::ExamSettings;

struct SealArguments {
  std::string name, task, level = "normal", thresholds, output;
};

base::Status Seal(const SealArguments& arguments) {
  ExamSettings settings;
  settings.name = arguments.name;
  auto operation = files::FindOperation(arguments.task, {}, 0);
  if (!operation.ok()) return operation.error();
  if (*operation) {
    settings.operation = arguments.task;
  } else {
    settings.task = arguments.task;
    settings.level = arguments.level;
  }
  if (!arguments.thresholds.empty()) {
    auto proficiency = assessment::FindProficiency(arguments.thresholds);
    if (!proficiency.ok()) return proficiency.error();
    if (proficiency->task != arguments.task || proficiency->level != settings.level) {
      return base::Error{base::ErrorCode::kExamInvalid,
                         "the thresholds \"" + arguments.thresholds + "\" are of " + proficiency->task +
                             (proficiency->level.empty() ? "" : ", level " + proficiency->level) +
                             ", and the exam is of another"};
    }
    settings.passes = std::move(proficiency->thresholds);
  }
  const auto sealed = assessment::SealExam(std::move(settings));
  if (!sealed.ok()) return sealed.error();
  const auto published = assessment::WriteExam(arguments.output, *sealed);
  if (!published.ok()) return published.error();
  Say("{1}: keep it secret until the exam is over\n{2}: publish it before the exam\nCommitment {3}\n",
      arguments.output, published->c_str(), sealed->commitment);
  return {};
}

struct RunArguments {
  std::string file, surgeon, record, cache;
  std::uint64_t hands = 1;
  double most_seconds = 3600;
  int threads = 1;
};

base::Status RunExam(const RunArguments& arguments) {
  const auto exam = assessment::ReadExam(arguments.file);
  if (!exam.ok()) return exam.error();
  auto description = assessment::DescribeExam(*exam, arguments.cache);
  if (!description.ok()) return description.error();
  description->player = "exam, " + arguments.surgeon + ", seed " + std::to_string(arguments.hands);
  auto made = record::MakeScene(*description);
  if (!made.ok()) return made.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*made));
  auto surgeon = agent::MakeSurgeon(arguments.surgeon, scene, arguments.hands);
  if (!surgeon.ok()) return surgeon.error();
  auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(arguments.threads)});
  if (!simulation.ok()) return simulation.error();
  auto recording = AttemptRecording::Start(arguments.record, *description, *simulation);
  if (!recording.ok()) return recording.error();
  host::ProgressBar bar("exam", arguments.most_seconds);
  while (!(*surgeon)->HasFinished() && simulation->GetSnapshot().time < arguments.most_seconds) {
    const scene::Input input = (*surgeon)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    recording->Add(input, *simulation);
    if (simulation->GetSnapshot().tick % 60 == 0) bar.Show(simulation->GetSnapshot().time);
  }
  bar.Finish();
  if (const auto finished = recording->Finish(*simulation); !finished.ok()) return finished;
  Say("{1}: {2} s of the exam \"{3}\"\nCertify it: trocar certificate issue {4} {1} --examinee PSEUDONYM "
      "--key "
      "FILE -o "
      "CERTIFICATE\n",
      arguments.record, host::ShownNumber(simulation->GetSnapshot().time, 4), exam->name, arguments.file);
  return {};
}

void AddSeal(CLI::App& exam, Outcome& outcome) {
  CLI::App* command = exam.add_subcommand(
      "seal", "Draw a secret seed, and write the exam's settings with what is to be published before");
  auto a = std::make_shared<SealArguments>();
  command->add_option("--task", a->task, "Task, or operation on a patient that nobody has seen")
      ->required()
      ->type_name("TASK");
  command->add_option("--level", a->level, "Of a task")->type_name("LEVEL")->capture_default_str();
  command->add_option("--name", a->name, "Name of the exam")->required()->type_name("TEXT");
  command
      ->add_option("--thresholds", a->thresholds,
                   "What passes (trocar levels list), or a file; else completing does")
      ->type_name("LEVELS");
  command->add_option("-o,--output", a->output, "File of the exam; only its owner may read it")
      ->required()
      ->type_name("FILE");
  command->footer("Example: trocar exam seal --task peg_transfer --name \"Finals 2026\" -o finals.json");
  command->callback([a, &outcome] { outcome.status = Seal(*a); });
}

void AddRun(CLI::App& exam, Outcome& outcome) {
  CLI::App* command = exam.add_subcommand("run", "Hold an exam with a scripted surgeon, and record it");
  auto a = std::make_shared<RunArguments>();
  command->add_option("file", a->file, "File of the exam, as trocar exam seal wrote it")
      ->required()
      ->type_name("FILE");
  command->add_option("--surgeon", a->surgeon, "Who is examined (trocar play --list)")
      ->required()
      ->type_name("SURGEON");
  command->add_option("--record", a->record, "Recording to write")->required()->type_name("FILE");
  command->add_option("--seed", a->hands, "Of the hands; the exam's own seed is sealed")
      ->check(CLI::Range(0, 2147483647))
      ->type_name("K")
      ->capture_default_str();
  command->add_option("--seconds", a->most_seconds, "Simulated time after which the surgeon is stopped")
      ->check(CLI::Range(1.0, 3600.0))
      ->type_name("S")
      ->capture_default_str();
  AddCacheOption(*command, a->cache);
  AddThreadsOption(*command, a->threads);
  command->footer("Example: trocar exam run finals.json --surgeon expert --record finals-7.trocar");
  command->callback([a, &outcome] { outcome.status = RunExam(*a); });
}

}  // namespace

void AddExamCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "exam");
  command->require_subcommand(1);
  AddSeal(*command, outcome);
  AddRun(*command, outcome);
  CLI::App* check =
      command->add_subcommand("check", "Say whether an exam's settings are those that were published");
  auto file = std::make_shared<std::string>(), published = std::make_shared<std::string>();
  check->add_option("file", *file, "File of the exam")->required()->type_name("FILE");
  check->add_option("published", *published, "What was published before")->required()->type_name("PUBLISHED");
  check->callback([=, &outcome] {
    const auto exam = assessment::ReadExam(*file);
    outcome.status = exam.ok() ? assessment::CheckPublished(*published, *exam) : base::Status(exam.error());
    if (outcome.status.ok()) Say("{1}: sealed as published, seed {2}\n", file->c_str(), exam->seed);
  });
}

}  // namespace trocar::cli
