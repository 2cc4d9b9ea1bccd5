// SPDX-License-Identifier: Apache-2.0
/// \file reproduce_command.cpp  `trocar reproduce table1 | ... | all`.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "benchmark.h"
#include "command.h"
#include "console.h"
#include "experiment.h"
#include "trocar/core/safe_file.h"

namespace trocar::cli {
namespace {

constexpr std::array<ExperimentEntry, 7> kExperiments = {{
    {"table1", "Table 1: points, edges and triangles of the four meshes", ReproduceTable1},
    {"table2", "Table 2: shape conservation by virtual springs, on the liver and on a grid", ReproduceTable2},
    {"fig6", "Figure 6: collision search over mesh size, greedy and exact", ReproduceFigure6},
    {"fig7", "Figure 7: update of the collision hierarchy over mesh size", ReproduceFigure7},
    {"fig8", "Figure 8: time of an iteration of every solver and GPU layout", ReproduceFigure8},
    {"fig9", "Figure 9: speed-up over the paper's relaxation", ReproduceFigure9},
    {"equilibrium", "Section V: an error below 0.0005 in a frame", ReproduceEquilibrium},
}};

struct Arguments {
  std::string folder, markdown;
  ExperimentOptions options;
  bool is_json = false;
};

core::Result<std::vector<Experiment>> Run(std::span<const ExperimentEntry> entries,
                                          const Arguments& arguments) {
  std::vector<Experiment> done;
  ExperimentStore store;
  for (const ExperimentEntry& entry : entries) {
    ProgressBar bar("reproduce " + std::string(entry.name), 1.0);
    ExperimentOptions options = arguments.options;
    options.progress = [&bar](double part) { bar.Show(part); };
    ExperimentResult result = entry.run(options, store);
    bar.Finish();
    if (!result) return result.error();
    if (options.is_quick)
      result->notes.emplace_back(
          "A quick run: smaller meshes, fewer repeats; its times are no figures to quote.");
    // a person reads on while the next one runs
    if (!arguments.is_json) {
      std::printf("%s\n", FormatExperimentText(*result).c_str());
      std::fflush(stdout);
    }
    done.push_back(std::move(result).value());
  }
  return done;
}

core::Status WritePages(const std::vector<Experiment>& experiments, const Arguments& arguments,
                        bool has_index, const std::string& machine) {
  const std::filesystem::path folder = arguments.folder;
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);  // a failure shows where a file is written
  core::Status status;
  const auto write = [&](const std::string& name, const std::string& text) {
    if (status) status = core::WriteFile(folder / name, text);
  };
  for (const Experiment& experiment : experiments) {
    write(experiment.name + ".html", FormatExperimentPage(experiment, machine));
    write(experiment.name + ".json", FormatExperimentsJson(std::span(&experiment, 1), machine));
    for (std::size_t i = 0; i < experiment.plots.size(); ++i) {
      const std::string number = i == 0 ? "" : "-" + std::to_string(i + 1);
      write(experiment.name + number + ".svg", FormatSvgFile(experiment.plots[i]));
    }
  }
  if (has_index) write("index.html", FormatExperimentIndex(experiments, machine));
  return status;
}

core::Status UpdateDocument(const std::vector<Experiment>& experiments, const std::string& path,
                            const std::string& machine) {
  const auto document = core::ReadFile(path);
  if (!document) return document.error();
  const auto updated = ReplaceGeneratedPart(*document, FormatExperimentsMarkdown(experiments, machine));
  if (!updated) return core::Error{updated.error().code, path + ": " + updated.error().message};
  return core::WriteFile(path, *updated);
}

core::Status Reproduce(std::span<const ExperimentEntry> entries, const Arguments& arguments, bool is_all) {
  const std::string machine = DescribeMachine() + ", " + std::to_string(arguments.options.threads) +
                              (arguments.options.threads == 1 ? " thread" : " threads");
  const auto experiments = Run(entries, arguments);
  if (!experiments) return experiments.error();
  if (arguments.is_json) std::fputs(FormatExperimentsJson(*experiments, machine).c_str(), stdout);
  if (!arguments.folder.empty()) {
    if (core::Status status = WritePages(*experiments, arguments, is_all, machine); !status) return status;
    const std::string page = is_all ? "index.html" : experiments->front().name + ".html";
    if (!arguments.is_json)
      std::printf("Page: %s\n", (std::filesystem::path(arguments.folder) / page).string().c_str());
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
  command.add_option("--threads", arguments->options.threads, "Of the solvers that can use more than one")
      ->check(CLI::Range(1, 256))
      ->type_name("T")
      ->capture_default_str();
  command.add_option("--repeats", arguments->options.repeats, "The quickest of so many runs counts")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command.add_flag("--json", arguments->is_json, "Machine-readable, in place of the tables");
}

}  // namespace

std::span<const ExperimentEntry> Experiments() noexcept {
  return kExperiments;
}

void AddReproduceCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* reproduce =
      app.add_subcommand("reproduce", "Repeat the paper's experiments, its figures beside ours");
  reproduce->require_subcommand(1);
  for (const ExperimentEntry& entry : kExperiments) {
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
  all->callback([arguments, &outcome] { outcome.status = Reproduce(kExperiments, *arguments, true); });
  AddReportCardCommand(*reproduce, outcome);
  reproduce->footer(
      "Figures of the paper that stand only in its pictures are printed as \"not readable\".\n"
      "Example: trocar reproduce all -o out/reproduce --threads 2");
}

}  // namespace trocar::cli
