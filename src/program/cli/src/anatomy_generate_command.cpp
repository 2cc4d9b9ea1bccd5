// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "anatomy_settings.h"
#include "command.h"
#include "console.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_parameters.h"
#include "trocar/anatomy/patient_population.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/clock.h"
#include "trocar/patient/patient.h"

namespace trocar::cli {

using host::PrintTable;
using host::Say;
using host::ShownNumber;
using host::TranslateWith;

namespace {

/// A chi-square that chance alone exceeds less often than this is called a deviation.
constexpr double kSignificance = 0.01;

struct GenerateArguments {
  std::uint64_t seed = 0;
  std::size_t count = 1;
  std::string output;
  std::vector<std::string> settings;
  bool is_list = false, is_summary = false;
};

std::string FormatValue(const std::variant<double, std::string>& value) {
  const double* number = std::get_if<double>(&value);
  return number != nullptr ? ShownNumber(*number) : std::get<std::string>(value);
}

/// What a parameter is drawn from, in words.
std::string FormatRule(const anatomy::ParameterRule& rule) {
  const auto number = [](double value) { return ShownNumber(value); };
  switch (rule.distribution) {
    case anatomy::Distribution::kNormal:
      return TranslateWith("{1} +- {2}, {3} to {4}",
                           {number(rule.centre), number(rule.spread), number(rule.low), number(rule.high)});
    case anatomy::Distribution::kLognormal:
      return TranslateWith("median {1}, log deviation {2}, {3} to {4}",
                           {number(rule.centre), number(rule.spread), number(rule.low), number(rule.high)});
    case anatomy::Distribution::kChance:
      return TranslateWith("yes in {1} %", {number(100 * rule.centre)});
    case anatomy::Distribution::kChoice: {
      double total = 0;
      for (const anatomy::Choice& choice : rule.choices) total += choice.weight;
      std::string text;
      for (const anatomy::Choice& choice : rule.choices) {
        text += (text.empty() ? "" : ", ") + std::string(choice.name) + " " +
                ShownNumber(100 * choice.weight / total, 3) + " %";
      }
      return text;
    }
    case anatomy::Distribution::kFixed:
      return TranslateWith("{1} unless set, {2} to {3}",
                           {number(rule.centre), number(rule.set_low), number(rule.set_high)});
  }
  return {};
}

void PrintRules() {
  std::vector<std::vector<std::string>> rows = {{"name", "unit", "drawn from", "what it is", "source"}};
  for (const anatomy::ParameterRule& rule : anatomy::ParameterRules()) {
    rows.push_back({std::string(rule.name), std::string(rule.unit), FormatRule(rule),
                    host::Translate(rule.about), std::string(rule.source)});
  }
  PrintTable(rows);
}

void PrintParameters(const patient::Patient& patient) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "unit", "source"}};
  for (const patient::Parameter& parameter : patient.parameters) {
    rows.push_back({parameter.name, FormatValue(parameter.value), parameter.unit, parameter.source});
  }
  PrintTable(rows);
}

void PrintVariations(const std::vector<anatomy::VariationCount>& variations) {
  std::vector<std::vector<std::string>> rows = {{"variation", "value", "configured [%]", "observed [%]",
                                                 "count", "of", "deviation [s]", "chi-square", "p"}};
  std::size_t deviating = 0;
  for (const anatomy::VariationCount& variation : variations) {
    const bool is_deviating = variation.p_value < kSignificance / static_cast<double>(variations.size());
    deviating += is_deviating ? 1 : 0;
    for (std::size_t i = 0; i < variation.values.size(); ++i) {
      const anatomy::ValueCount& value = variation.values[i];
      const double share = static_cast<double>(value.observed) / static_cast<double>(variation.patients);
      const double deviation =
          anatomy::CalcBinomialDeviation(value.configured, value.observed, variation.patients);
      rows.push_back({i == 0 ? variation.parameter : "", value.value, ShownNumber(100 * value.configured, 3),
                      ShownNumber(100 * share, 3), std::to_string(value.observed),
                      std::to_string(variation.patients), host::ShownFixed(deviation, 2, true)});
      if (i == 0) {
        rows.back().push_back(ShownNumber(variation.chi_square, 3));
        rows.back().push_back(ShownNumber(variation.p_value, 3));
      }
    }
  }
  PrintTable(rows);
  Say("\nDeviation: in standard deviations of the binomial distribution. p: how often chance alone gives a\n"
      "chi-square at least as large. ");
  if (deviating == 0) {
    Say("All frequencies are within the sampling error of the configured ones\n(no p below {1} over {2} "
        "tests).\n",
        ShownNumber(kSignificance), variations.size());
  } else {
    Say("{1} of {2} variations deviate (p below {3} over the number of tests).\n", deviating,
        variations.size(), ShownNumber(kSignificance));
  }
}

void PrintPopulation(const anatomy::PopulationReport& report, double seconds) {
  constexpr std::size_t kNamed = 10;  // seeds listed at most
  Say("{1} patients in {2} s, {3} seeds failed\n", report.patients, host::ShownFixed(seconds, 0),
      report.failures.size());
  Say("meshes: {1}, closed {2}, manifold {3}, self-intersections {4}, smallest angle {5} degrees\n",
      report.meshes, report.closed_meshes, report.manifold_meshes, report.self_intersections,
      ShownNumber(report.smallest_angle_deg, 3));
  std::string findings;
  for (const auto& [code, count] : report.findings) findings += code + " " + std::to_string(count) + "  ";
  Say("linter: {1}\n", findings.empty() ? host::Translate("silent for every patient") : findings);
  if (!report.seeds_with_findings.empty()) {
    Say("seeds with findings:");
    for (std::size_t i = 0; i < report.seeds_with_findings.size() && i < kNamed; ++i)
      host::Print(" " + std::to_string(report.seeds_with_findings[i]));
    host::PrintLine(report.seeds_with_findings.size() > kNamed ? " ..." : "");
  }
  for (std::size_t i = 0; i < report.failures.size() && i < kNamed; ++i) {
    Say("seed {1}: {2}\n", report.failures[i].first, host::ShownText(report.failures[i].second));
  }
  host::PrintLine();
  if (!report.variations.empty()) PrintVariations(report.variations);
}

base::Status GenerateMany(const GenerateArguments& arguments,
                          std::vector<anatomy::ParameterSetting> settings) {
  anatomy::PopulationSettings population;
  population.first_seed = arguments.seed;
  population.count = arguments.count;
  population.parameters = std::move(settings);
  anatomy::PatientSink sink;
  if (!arguments.output.empty()) {
    sink = [&](std::uint64_t seed, const patient::Patient& patient) {
      return files::WritePatient(std::filesystem::path(arguments.output) / ("seed-" + std::to_string(seed)),
                                 patient);
    };
  }
  host::ProgressBar bar("generating " + std::to_string(arguments.count) + " patients",
                        static_cast<double>(arguments.count));
  const host::Stopwatch stopwatch;
  const auto report = anatomy::GeneratePopulation(
      population, sink, [&](std::size_t done) { bar.Show(static_cast<double>(done)); });
  bar.Finish();
  if (!report) return report.error();
  PrintPopulation(*report, stopwatch.Seconds());
  if (!arguments.output.empty()) Say("\nWrote {1} patients into {2}\n", report->patients, arguments.output);
  if (report->IsSound()) return {};
  return base::Error{base::ErrorCode::kPatientInvalid,
                     std::to_string(report->failures.size() + report->seeds_with_findings.size()) +
                         " of the seeds gave no patient or one with findings; the list above names them"};
}

base::Status Generate(const GenerateArguments& arguments) {
  if (arguments.is_list) {
    PrintRules();
    return {};
  }
  const bool is_many = arguments.count > 1 || arguments.is_summary;
  if (arguments.output.empty() && !is_many) {
    return base::Error{base::ErrorCode::kUsage,
                       "name the patient folder to write with -o PATIENT, or ask for --summary"};
  }
  auto settings = ParseSettings(arguments.settings);
  if (!settings) return settings.error();
  if (is_many) return GenerateMany(arguments, std::move(*settings));
  const base::Result<patient::Patient> patient = anatomy::GeneratePatient(arguments.seed, *settings);
  if (!patient) return patient.error();
  if (auto status = files::WritePatient(arguments.output, *patient); !status) return status;
  PrintParameters(*patient);
  Say("\nWrote {1}\n", arguments.output);
  return {};
}

}  // namespace

void AddAnatomyGenerateCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* generate = anatomy.add_subcommand("generate", "Make a plausible patient without any images");
  auto arguments = std::make_shared<GenerateArguments>();
  generate->add_option("--seed", arguments->seed, "The same seed and settings give the same patient")
      ->type_name("N")
      ->capture_default_str();
  generate
      ->add_option("-o,--output", arguments->output,
                   "Patient folder to write; with several patients, the folder for them: seed-7, seed-8, ...")
      ->type_name("PATIENT");
  generate->add_option("--count", arguments->count, "So many patients, from seeds N, N + 1, ...")
      ->check(CLI::Range(1, 1000000))
      ->type_name("M")
      ->capture_default_str();
  generate->add_flag(
      "--summary", arguments->is_summary,
      "Print how sound the patients are, and how often each variation occurs against how often it "
      "should; needs no output folder");
  generate
      ->add_option("--set", arguments->settings,
                   "Value in place of a drawn one, name=value; may be given several times")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  generate->add_flag("--list", arguments->is_list, "Print every parameter with its distribution and source");
  generate->footer(
      "Every value that was drawn, set or measured is listed and kept in the patient's file.\n"
      "Examples: trocar anatomy generate --seed 7 -o out/seven\n"
      "          trocar anatomy generate --seed 7 --set moynihan_hump=yes --set hydrops=1 -o out/seven\n"
      "          trocar anatomy generate --seed 1 --count 1000 --summary\n"
      "          trocar demo --patient out/seven -o out/demo");
  generate->callback([arguments, &outcome] { outcome.status = Generate(*arguments); });
}

}  // namespace trocar::cli
