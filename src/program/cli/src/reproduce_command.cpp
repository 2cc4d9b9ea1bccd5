// SPDX-License-Identifier: Apache-2.0
/// \file reproduce_command.cpp  `trocar reproduce table1 | ... | all`.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/bench/benchmark.h"
#include "trocar/bench/experiment.h"
#include "trocar/host/safe_file.h"

namespace trocar::cli {
namespace {

struct Arguments {
  std::string folder, markdown;
  bench::ExperimentOptions options;
  bool is_json = false;
};

base::Result<std::vector<bench::Experiment>> RunExperiments(std::span<const bench::ExperimentEntry> entries,
                                                            const Arguments& arguments) {
  std::vector<bench::Experiment> done;
  bench::ExperimentStore store;
  for (const bench::ExperimentEntry& entry : entries) {
    host::ProgressBar bar("reproduce " + std::string(entry.name), 1.0);
    bench::ExperimentOptions options = arguments.options;
    options.progress = [&bar](double part) { bar.Show(part); };
    bench::ExperimentResult result = entry.run(options, store);
    bar.Finish();
    if (!result) return result.error();
    if (options.is_quick)
      result->notes.emplace_back(
          "A quick run: smaller meshes, fewer repeats; its times are no figures to quote.");
    // a person reads on while the next one runs
    if (!arguments.is_json) {
      host::PrintLines(bench::FormatExperimentText(*result) + "\n");
      std::fflush(stdout);
    }
    done.push_back(std::move(result).value());
  }
  return done;
}

base::Status WritePages(const std::vector<bench::Experiment>& experiments, const Arguments& arguments,
                        bool has_index, const std::string& machine) {
  const std::filesystem::path folder = arguments.folder;
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);  // a failure shows where a file is written
  base::Status status;
  const auto write = [&](const std::string& name, const std::string& text) {
    if (status) status = host::WriteFile(folder / name, text);
  };
  for (const bench::Experiment& experiment : experiments) {
    write(experiment.name + ".html", bench::FormatExperimentPage(experiment, machine));
    write(experiment.name + ".json", bench::FormatExperimentsJson(std::span(&experiment, 1), machine));
    for (std::size_t i = 0; i < experiment.plots.size(); ++i) {
      const std::string number = i == 0 ? "" : "-" + std::to_string(i + 1);
      write(experiment.name + number + ".svg", bench::FormatSvgFile(experiment.plots[i]));
    }
  }
  if (has_index) write("index.html", bench::FormatExperimentIndex(experiments, machine));
  return status;
}

base::Status UpdateDocument(const std::vector<bench::Experiment>& experiments, const std::string& path,
                            const std::string& machine) {
  const auto document = host::ReadFile(path);
  if (!document) return document.error();
  const auto updated =
      bench::ReplaceGeneratedPart(*document, bench::FormatExperimentsMarkdown(experiments, machine));
  if (!updated) return base::Error{updated.error().code, path + ": " + updated.error().message};
  return host::WriteFile(path, *updated);
}

base::Status Reproduce(std::span<const bench::ExperimentEntry> entries, const Arguments& arguments,
                       bool is_all) {
  const std::string machine = bench::DescribeMachine() + ", " + std::to_string(arguments.options.threads) +
                              (arguments.options.threads == 1 ? " thread" : " threads");
  const auto experiments = RunExperiments(entries, arguments);
  if (!experiments) return experiments.error();
  if (arguments.is_json) host::PrintLines(bench::FormatExperimentsJson(*experiments, machine));
  if (!arguments.folder.empty()) {
    if (base::Status status = WritePages(*experiments, arguments, is_all, machine); !status) return status;
    const std::string page = is_all ? "index.html" : experiments->front().name + ".html";
    if (!arguments.is_json)
      host::Say("Page: {1}\n", (std::filesystem::path(arguments.folder) / page).string());
  }
  if (arguments.markdown.empty()) return {};
  return UpdateDocument(*experiments, arguments.markdown, machine);
}

void AddOptions(CLI::App& command, const std::shared_ptr<Arguments>& arguments) {
  command
      .add_option("-o,--output", arguments->folder,
                  "Folder for the page (HTML), the plots (SVG) and the numbers (JSON)")
      ->type_name("FOLDER");
  command.add_flag("--quick", arguments->options.is_quick, "Smaller meshes: seconds instead of minutes");
  AddThreadsOption(command, arguments->options.threads, "Of the solvers that can use more than one");
  command.add_option("--repeats", arguments->options.repeats, "The quickest of so many runs counts")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  AddJsonFlag(command, arguments->is_json, "Machine-readable, in place of the tables");
}

}  // namespace

void AddReproduceCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* reproduce = AddListed(app, "reproduce");
  reproduce->require_subcommand(1);
  for (const bench::ExperimentEntry& entry : bench::Experiments()) {
    CLI::App* command = reproduce->add_subcommand(std::string(entry.name), std::string(entry.description));
    const auto arguments = std::make_shared<Arguments>();
    AddOptions(*command, arguments);
    command->callback([&entry, arguments, &outcome] {
      outcome.status = Reproduce(std::span(&entry, 1), *arguments, false);
    });
  }
  CLI::App* all = reproduce->add_subcommand("all", "All of them, with one page that links them");
  const auto arguments = std::make_shared<Arguments>();
  AddOptions(*all, arguments);
  all->add_option("--markdown", arguments->markdown,
                  "Document whose generated part is written anew (docs/replicability.md)")
      ->type_name("FILE");
  all->callback(
      [arguments, &outcome] { outcome.status = Reproduce(bench::Experiments(), *arguments, true); });
  AddReportCardCommand(*reproduce, outcome);
  reproduce->footer(
      "Figures of the paper that stand only in its pictures are printed as \"not readable\".\n"
      "Example: trocar reproduce all -o out/reproduce --threads 2");
}

}  // namespace trocar::cli
