// SPDX-License-Identifier: Apache-2.0
/// \file study_command.cpp  `trocar study`: which metrics find out what scripted people were made to be; with a plan, any
/// study of parameters, patients, surgeons and seeds.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/bench/benchmark.h"
#include "trocar/bench/validity_study.h"
#include "trocar/host/program.h"
#include "trocar/host/safe_file.h"
#include "trocar/study/study.h"

namespace trocar::cli {

using host::Say;

namespace {

struct StudyArguments {
  bench::StudyOptions options;
  std::string output;
  bool has_levels_only = false;
  std::string plan, backend = "local", worker;
  int attempts = 3;
  std::vector<std::string> launch;
};

base::Status WriteStudy(const StudyArguments& arguments, const std::vector<bench::StudyAttempt>& attempts) {
  const auto findings = bench::FindOutOfStudy(arguments.options, attempts);
  const std::filesystem::path folder = arguments.output;
  const auto write = [&](const char* name, const std::string& content) {
    return host::WriteFile(folder / name, content);
  };
  if (auto s = write("study.html",
                     bench::FormatStudyPage(arguments.options, findings, attempts, bench::DescribeMachine()));
      !s.ok())
    return s;
  if (auto s = write("findings.json", bench::FormatStudyJson(arguments.options, findings)); !s.ok()) return s;
  if (auto s = write("findings.csv", bench::FormatStudyCsv(findings)); !s.ok()) return s;
  if (auto s = write("validity.json", bench::FormatValidityJson(arguments.options, findings)); !s.ok())
    return s;
  std::vector<std::vector<std::string>> rows = {
      {"task", "attempts", "completed", "numbers", "separate without overlap", "say the same"}};
  for (const bench::TaskFindings& task : findings) {
    const auto separating = std::count_if(task.metrics.begin(), task.metrics.end(),
                                          [](const auto& finding) { return finding.separates; });
    rows.push_back({task.task, std::to_string(task.attempts), std::to_string(task.completed),
                    std::to_string(task.metrics.size()), std::to_string(separating),
                    host::TranslateWith("{1} groups", {std::to_string(task.clusters.size())})});
  }
  host::PrintTable(rows);
  Say("\nPage: {1}\n", (folder / "study.html").string());
  Say("The people are made by a program: this sets no standard of competence.\n");
  return {};
}

base::Status Study(const StudyArguments& arguments, Outcome& outcome) {
  bench::StudyOptions options = arguments.options;
  options.folder = arguments.output;
  options.has_weaknesses = options.has_careless = !arguments.has_levels_only;
  const auto wanted = bench::CountStudyAttempts(options);
  if (!wanted.ok()) return wanted.error();
  host::ProgressBar progress("playing", 1.0);
  const auto attempts = bench::RunStudy(options, progress.Follow());
  progress.Finish();
  if (!attempts.ok()) return attempts.error();
  StudyArguments done = arguments;
  done.options = options;
  if (auto status = WriteStudy(done, *attempts); !status.ok()) return status;
  if (attempts->size() < *wanted) {
    Say("{1} of {2} attempts are done; the same command goes on.\n", attempts->size(), *wanted);
    outcome.has_finding = true;
  }
  return {};
}

/// Runs of a plan; as a worker, a share of them.
base::Status RunPlan(const StudyArguments& arguments, Outcome& outcome) {
  study::StudyOptions options;
  options.plan_file = arguments.plan;
  options.folder = arguments.output;
  options.workers = arguments.options.jobs;
  options.attempts = arguments.attempts;
  options.launch = arguments.launch;
  options.program = host::FindProgram();
  const auto backend = study::FindBackend(arguments.backend);
  if (!backend)
    return base::Error{base::ErrorCode::kUsage,
                       "--backend is local, slurm or mpi; this is \"" + arguments.backend + "\""};
  options.backend = *backend;
  const auto plan = study::ReadPlan(options.plan_file);
  if (!plan) return plan.error();
  if (!arguments.worker.empty()) {
    const auto worker = study::FindWorker(arguments.worker);
    if (!worker) return worker.error();
    return study::Work(options, *plan, *worker);
  }
  host::ProgressBar progress("runs", 1.0);
  const auto summary = study::RunStudy(options, *plan, [&](double share) { progress.Show(share); });
  progress.Finish();
  if (!summary) return summary.error();
  Say("{1} of {2} runs are done; {3} failed\n", summary->done, summary->runs, summary->failed);
  for (const std::string& line : summary->failures) host::PrintLine("  " + host::TranslateComposed(line));
  if (summary->done < summary->runs) {
    Say("The same command goes on.\n");
    outcome.has_finding = true;
  }
  const std::filesystem::path folder = arguments.output;
  Say("Table: {1}, {2}\nPage: {3}\n", folder / "runs.csv", folder / "runs.sqlite", folder / "report.html");
  return {};
}

}  // namespace

void AddStudyCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "study");
  auto a = std::make_shared<StudyArguments>();
  a->options.tasks = {"instrument_navigation"};
  command
      ->add_option("plan", a->plan,
                   "A plan (schemas/study-plan.schema.json; samples/studies); --jobs, -o and the four below "
                   "belong to it")
      ->type_name("PLAN.json");
  command
      ->add_option("--backend", a->backend,
                   "Of a plan: local (processes here), slurm (a job array), mpi (mpirun)")
      ->type_name("BACKEND")
      ->capture_default_str();
  command->add_option("--attempts", a->attempts, "Of a plan: that a run gets before it is named as failed")
      ->check(CLI::Range(1, 100))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option(
          "--launch", a->launch,
          "Of a plan: one more option for sbatch or mpirun, as --launch=--partition=short; may repeat")
      ->allow_extra_args(false)
      ->type_name("OPTION");
  command
      ->add_option("--worker", a->worker,
                   "Of a plan: do only this share of the runs (INDEX/COUNT, or auto in a Slurm array or "
                   "under mpirun), and "
                   "collect nothing")
      ->type_name("I/N");
  command
      ->add_option("--task", a->options.tasks,
                   "Names of training tasks (trocar play --list), or files, with commas between")
      ->delimiter(',')
      ->type_name("TASK,...")
      ->capture_default_str();
  command->add_option("--level", a->options.level, "Difficulty, one of the tasks'")
      ->type_name("LEVEL")
      ->capture_default_str();
  command
      ->add_option(
          "--people", a->options.people,
          "Of each group: novice, intermediate, expert, with one weakness each, careless in one way each")
      ->check(CLI::Range(2, 10000))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--repeats", a->options.repeats,
                   "Attempts of each novice, intermediate and expert, on other seeds: for the reliability")
      ->check(CLI::Range(1, 20))
      ->type_name("R")
      ->capture_default_str();
  command
      ->add_option(
          "--patients", a->options.patients,
          "Generated patients on whom each novice, intermediate and expert does a task that has one, as "
          "scenes/study/gallbladder_retraction.json: for the reliability over patients")
      ->check(CLI::Range(1, 100))
      ->type_name("P");
  command->add_option("--spread", a->options.spread, "By which share people of a group differ")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("SHARE")
      ->capture_default_str();
  command->add_option("--seed", a->options.seed, "The first of the seeds of people, tasks and hands")
      ->check(CLI::Range(0, 2147483647))
      ->type_name("K")
      ->capture_default_str();
  command
      ->add_option("--jobs", a->options.jobs,
                   "Attempts or workers at a time; what comes out is the same for any number")
      ->check(CLI::Range(1, 256))
      ->type_name("J")
      ->capture_default_str();
  command
      ->add_option(
          "--most-seconds", a->options.most_seconds,
          "Stop after this time; the same command goes on where it stopped (exit status 1 until it is done)")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("S");
  command->add_flag("--levels-only", a->has_levels_only,
                    "Leave out people with one weakness and careless ones");
  command
      ->add_option("-o,--output", a->output,
                   "Folder for study.html, findings.json, findings.csv, validity.json, and attempts.jsonl "
                   "from which a "
                   "stopped study goes on")
      ->required()
      ->type_name("DIR");
  command->footer(
      "The people are made by a program: what separates them may not separate residents.\n"
      "A plan's results are kept by the SHA-256 of their inputs: a study that was stopped goes on with the "
      "same command, a run\n"
      "that fails is tried again and then named, none counts twice. DIR gets runs.csv, runs.sqlite and "
      "report.html.\n"
      "Examples:\n"
      "  trocar study --task instrument_navigation,peg_transfer --people 50 --jobs 4 -o study\n"
      "  trocar study --task scenes/study/gallbladder_retraction.json --levels-only --people 6 --patients 5 "
      "-o "
      "patients\n"
      "  trocar study samples/studies/stiffness.json --jobs 2 -o out/stiffness\n"
      "  trocar study plan.json --backend slurm --jobs 64 --launch=--time=2:00:00 -o out/plan");
  command->callback(
      [a, &outcome] { outcome.status = a->plan.empty() ? Study(*a, outcome) : RunPlan(*a, outcome); });
}

}  // namespace trocar::cli
