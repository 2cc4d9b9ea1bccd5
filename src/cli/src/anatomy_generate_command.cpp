// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "command.h"
#include "console.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_parameters.h"
#include "trocar/anatomy/patient_population.h"
#include "trocar/core/clock.h"

namespace trocar::cli {
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
  return number != nullptr ? FormatNumber(*number) : std::get<std::string>(value);
}

/// What a parameter is drawn from, in words.
std::string FormatRule(const anatomy::ParameterRule& rule) {
  const auto number = [](double value) { return FormatNumber(value); };
  switch (rule.distribution) {
    case anatomy::Distribution::kNormal:
      return number(rule.centre) + " +- " + number(rule.spread) + ", " + number(rule.low) + " to " +
             number(rule.high);
    case anatomy::Distribution::kLognormal:
      return "median " + number(rule.centre) + ", log deviation " + number(rule.spread) + ", " +
             number(rule.low) + " to " + number(rule.high);
    case anatomy::Distribution::kChance:
      return "yes in " + number(100 * rule.centre) + " %";
    case anatomy::Distribution::kChoice: {
      double total = 0;
      for (const anatomy::Choice& choice : rule.choices) total += choice.weight;
      std::string text;
      for (const anatomy::Choice& choice : rule.choices) {
        text += (text.empty() ? "" : ", ") + std::string(choice.name) + " " +
                FormatNumber(100 * choice.weight / total, 3) + " %";
      }
      return text;
    }
    case anatomy::Distribution::kFixed:
      return number(rule.centre) + " unless set, " + number(rule.set_low) + " to " + number(rule.set_high);
  }
  return {};
}

void PrintRules() {
  std::vector<std::vector<std::string>> rows = {{"name", "unit", "drawn from", "what it is", "source"}};
  for (const anatomy::ParameterRule& rule : anatomy::ParameterRules()) {
    rows.push_back({std::string(rule.name), std::string(rule.unit), FormatRule(rule), std::string(rule.about),
                    std::string(rule.source)});
  }
  std::fputs(FormatTable(rows).c_str(), stdout);
}

void PrintParameters(const anatomy::Patient& patient) {
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "unit", "source"}};
  for (const anatomy::Parameter& parameter : patient.parameters) {
    rows.push_back({parameter.name, FormatValue(parameter.value), parameter.unit, parameter.source});
  }
  std::fputs(FormatTable(rows).c_str(), stdout);
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
      char text[32];
      std::snprintf(text, sizeof text, "%+.2f", deviation);
      rows.push_back({i == 0 ? variation.parameter : "", value.value, FormatNumber(100 * value.configured, 3),
                      FormatNumber(100 * share, 3), std::to_string(value.observed),
                      std::to_string(variation.patients), text});
      if (i == 0) {
        rows.back().push_back(FormatNumber(variation.chi_square, 3));
        rows.back().push_back(FormatNumber(variation.p_value, 3));
      }
    }
  }
  std::fputs(FormatTable(rows).c_str(), stdout);
  std::printf(
      "\nDeviation: in standard deviations of the binomial distribution. p: how often chance alone gives a\n"
      "chi-square at least as large. ");
  if (deviating == 0) {
    std::printf(
        "All frequencies are within the sampling error of the configured ones\n(no p below %g over %zu "
        "tests).\n",
        kSignificance, variations.size());
  } else {
    std::printf("%zu of %zu variations deviate (p below %g over the number of tests).\n", deviating,
                variations.size(), kSignificance);
  }
}

void PrintPopulation(const anatomy::PopulationReport& report, double seconds) {
  constexpr std::size_t kNamed = 10;  // seeds listed at most
  std::printf("%zu patients in %.0f s, %zu seeds failed\n", report.patients, seconds, report.failures.size());
  std::printf("meshes: %zu, closed %zu, manifold %zu, self-intersections %zu, smallest angle %s degrees\n",
              report.meshes, report.closed_meshes, report.manifold_meshes, report.self_intersections,
              FormatNumber(report.smallest_angle_deg, 3).c_str());
  std::printf("linter: ");
  if (report.findings.empty()) std::printf("silent for every patient");
  for (const auto& [code, count] : report.findings) std::printf("%s %zu  ", code.c_str(), count);
  std::printf("\n");
  if (!report.seeds_with_findings.empty()) {
    std::printf("seeds with findings:");
    for (std::size_t i = 0; i < report.seeds_with_findings.size() && i < kNamed; ++i)
      std::printf(" %llu", static_cast<unsigned long long>(report.seeds_with_findings[i]));
    std::printf("%s\n", report.seeds_with_findings.size() > kNamed ? " ..." : "");
  }
  for (std::size_t i = 0; i < report.failures.size() && i < kNamed; ++i) {
    std::printf("seed %llu: %s\n", static_cast<unsigned long long>(report.failures[i].first),
                report.failures[i].second.Text().c_str());
  }
  std::printf("\n");
  if (!report.variations.empty()) PrintVariations(report.variations);
}

core::Status GenerateMany(const GenerateArguments& arguments,
                          std::vector<anatomy::ParameterSetting> settings) {
  anatomy::PopulationSettings population;
  population.first_seed = arguments.seed;
  population.count = arguments.count;
  population.parameters = std::move(settings);
  anatomy::PatientSink sink;
  if (!arguments.output.empty()) {
    sink = [&](std::uint64_t seed, const anatomy::Patient& patient) {
      return anatomy::WritePatient(std::filesystem::path(arguments.output) / ("seed-" + std::to_string(seed)),
                                   patient);
    };
  }
  ProgressBar bar("generating " + std::to_string(arguments.count) + " patients",
                  static_cast<double>(arguments.count));
  const core::Stopwatch stopwatch;
  const auto report = anatomy::GeneratePopulation(
      population, sink, [&](std::size_t done) { bar.Show(static_cast<double>(done)); });
  bar.Finish();
  if (!report) return report.error();
  PrintPopulation(*report, stopwatch.Seconds());
  if (!arguments.output.empty())
    std::printf("\nWrote %zu patients into %s\n", report->patients, arguments.output.c_str());
  if (report->IsSound()) return {};
  return core::Error{core::ErrorCode::kPatientInvalid,
                     std::to_string(report->failures.size() + report->seeds_with_findings.size()) +
                         " of the seeds gave no patient or one with findings; the list above names them"};
}

core::Status Generate(const GenerateArguments& arguments) {
  if (arguments.is_list) {
    PrintRules();
    return {};
  }
  const bool is_many = arguments.count > 1 || arguments.is_summary;
  if (arguments.output.empty() && !is_many) {
    return core::Error{core::ErrorCode::kUsage,
                       "name the patient folder to write with -o PATIENT, or ask for --summary"};
  }
  auto settings = ParseSettings(arguments.settings);
  if (!settings) return settings.error();
  if (is_many) return GenerateMany(arguments, std::move(*settings));
  const core::Result<anatomy::Patient> patient = anatomy::GeneratePatient(arguments.seed, *settings);
  if (!patient) return patient.error();
  if (auto status = anatomy::WritePatient(arguments.output, *patient); !status) return status;
  PrintParameters(*patient);
  std::printf("\nWrote %s\n", arguments.output.c_str());
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
