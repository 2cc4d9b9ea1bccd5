// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/bench/benchmark.h"

namespace trocar::cli {
namespace {

struct BenchArguments {
  std::string suite;
  bench::BenchmarkOptions options;
  bool is_list = false, is_json = false;
};

std::string ListSuites() {
  std::vector<std::vector<std::string>> rows;
  for (const bench::BenchmarkSuite& suite : bench::BenchmarkSuites()) {
    rows.push_back({std::string(suite.name), host::Translate(suite.description)});
  }
  return host::FormatTable(rows);
}

void PrintForProgram(const std::string& suite, const bench::BenchmarkResult& result) {
  nlohmann::ordered_json json = {
      {"suite", suite}, {"machine", result.machine.empty() ? bench::DescribeMachine() : result.machine}};
  if (!result.notes.empty()) json["notes"] = result.notes;
  json["cases"] = nlohmann::ordered_json::array();
  for (const bench::BenchmarkCase& entry : result.cases) {
    json["cases"].push_back({{"name", entry.name}, {"value", entry.value}, {"unit", entry.unit}});
  }
  json["ratios"] = nlohmann::ordered_json::array();
  for (const bench::BenchmarkRatio& ratio : result.ratios) {
    json["ratios"].push_back({{"name", ratio.name}, {"value", ratio.value}});
  }
  PrintJson(json);
}

void PrintForPerson(const std::string& suite, const bench::BenchmarkResult& result) {
  host::Say("{1} on {2}\n\n", suite, result.machine.empty() ? bench::DescribeMachine() : result.machine);
  for (const std::string& note : result.notes) host::PrintLine(note);
  std::vector<std::vector<std::string>> rows = {{"case", "value", "unit"}};
  for (const bench::BenchmarkCase& entry : result.cases) {
    rows.push_back({entry.name, host::ShownNumber(entry.value), entry.unit == "1" ? "" : entry.unit});
  }
  for (const bench::BenchmarkRatio& ratio : result.ratios)
    rows.push_back({ratio.name, host::ShownNumber(ratio.value), host::Translate("times")});
  host::PrintTable(rows);
}

base::Status RunSuite(const BenchArguments& arguments) {
  if (arguments.is_list) {
    host::PrintLines(ListSuites());
    return {};
  }
  for (const bench::BenchmarkSuite& suite : bench::BenchmarkSuites()) {
    if (suite.name != arguments.suite) continue;
    const base::Result<bench::BenchmarkResult> result = suite.run(arguments.options);
    if (!result) return result.error();
    arguments.is_json ? PrintForProgram(arguments.suite, *result) : PrintForPerson(arguments.suite, *result);
    return {};
  }
  return base::Error{base::ErrorCode::kUsage,
                     (arguments.suite.empty() ? std::string("name a suite")
                                              : "there is no suite \"" + arguments.suite + "\"") +
                         "; trocar bench --list names them"};
}

}  // namespace

void AddBenchCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "bench");
  auto arguments = std::make_shared<BenchArguments>();
  command->add_option("suite", arguments->suite, "Which suite (--list)")->type_name("SUITE");
  command->add_flag("--list", arguments->is_list, "List the suites");
  AddThreadsOption(*command, arguments->options.threads, "For what can use more than one");
  command->add_option("--repeats", arguments->options.repeats, "The quickest of so many runs counts")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--attempts", arguments->options.attempts, "With how many attempts the store is filled")
      ->check(CLI::Range(1000, 10'000'000))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--steps", arguments->options.steps,
                   "Random actions of the soak over all environments, each twice; states must stay finite")
      ->check(CLI::Range(100, 100'000'000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Of the soak's actions")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--url", arguments->options.url,
                   "An empty PostgreSQL database for the store (postgresql://...)")
      ->type_name("URL");
  command
      ->add_option("--beside", arguments->options.beside,
                   "Another build's trocar: the operation is timed with both, by turns in one run")
      ->type_name("PROGRAM");
  command->add_flag("!--no-errors", arguments->options.judges_errors,
                    "Do not hold the operation's ticks against their equilibrium");
  command->add_option("--labels", arguments->options.labels, "Label map of liver and gallbladder for growth")
      ->type_name("FILE");
  AddJsonFlag(*command, arguments->is_json, "Machine-readable: suite, machine, cases, ratios");
  command->footer(
      "A case whose answer is wrong ends the suite with E-BEN-001 and exit status 1.\n"
      "Example: trocar bench tissue --threads 2");
  command->callback([arguments, &outcome] { outcome.status = RunSuite(*arguments); });
}

}  // namespace trocar::cli
