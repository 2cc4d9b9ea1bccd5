// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "anatomy_settings.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/anatomy/unseen_anatomy.h"
#include "trocar/files/patient_file.h"
#include "trocar/patient/patient.h"

namespace trocar::cli {

using host::PrintLine;
using host::Say;
using host::ShownNumber;

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kTen = 10;

struct CompleteArguments {
  std::string patient, output;
  std::vector<std::string> settings;
  bool is_likely = false, is_ten = false, is_worst = false, is_json = false;
  std::optional<std::uint64_t> seed;
  double at_least_percent = 0.1;
};

/// One patient that is written.
struct Completion {
  std::string what;  ///< "the most likely"
  fs::path folder;
  anatomy::UnseenVariant variant;
  std::vector<patient::Parameter> parameters;
  std::vector<anatomy::LintFinding> findings;
};

std::string FormatParameter(const patient::Parameter& parameter) {
  const double* number = std::get_if<double>(&parameter.value);
  return number != nullptr ? ShownNumber(*number) : std::get<std::string>(parameter.value);
}

base::Result<std::vector<Completion>> Plan(const CompleteArguments& arguments,
                                           const std::vector<anatomy::ParameterSetting>& settings) {
  const auto variants = anatomy::RankUnseenVariants(settings);
  if (!variants) return variants.error();
  std::vector<Completion> planned;
  const auto add = [&](std::string what, fs::path folder, const anatomy::UnseenVariant& variant,
                       base::Result<std::vector<patient::Parameter>> parameters) -> base::Status {
    if (!parameters) return parameters.error();
    planned.push_back({std::move(what), std::move(folder), variant, std::move(*parameters), {}});
    return {};
  };
  const fs::path output = arguments.output;
  base::Status status;
  if (arguments.seed) {
    auto drawn = anatomy::DrawUnseenParameters(*arguments.seed, settings);
    if (!drawn) return drawn.error();
    const auto variant = anatomy::FindVariant(*variants, *drawn);
    status = add("drawn with seed " + std::to_string(*arguments.seed), output, variant, std::move(drawn));
  } else if (arguments.is_worst) {
    const auto& worst = anatomy::FindWorstPlausible(*variants, arguments.at_least_percent / 100);
    status = add("the worst plausible", output, worst,
                 anatomy::MakeUnseenParameters(worst, anatomy::UnseenNumbers::kHard, settings));
  } else {
    const std::size_t count = arguments.is_ten ? std::min(kTen, variants->size()) : 1;
    for (std::size_t i = 0; i < count && status; ++i) {
      char number[16];
      std::snprintf(number, sizeof number, "%02zu", i + 1);
      const anatomy::UnseenVariant& variant = (*variants)[i];
      status = add(i == 0 ? "the most likely" : "number " + std::to_string(i + 1) + " by likelihood",
                   arguments.is_ten ? output / number : output, variant,
                   anatomy::MakeUnseenParameters(variant, anatomy::UnseenNumbers::kMiddle, settings));
    }
  }
  if (!status) return status.error();
  return planned;
}

ordered_json MakeVariantsJson(const std::vector<Completion>& all, bool keeps_tubes) {
  ordered_json json = {{"keeps_seen_tubes", keeps_tubes}, {"variants", ordered_json::array()}};
  for (const Completion& one : all) {
    ordered_json parameters = ordered_json::array(), findings = ordered_json::array();
    for (const patient::Parameter& parameter : one.parameters) {
      ordered_json value;
      std::visit([&](const auto& it) { value = it; }, parameter.value);
      parameters.push_back({{"name", parameter.name},
                            {"value", value},
                            {"unit", parameter.unit},
                            {"source", parameter.source}});
    }
    for (const anatomy::LintFinding& finding : one.findings)
      findings.push_back({{"code", finding.code}, {"where", finding.where}, {"text", finding.text}});
    json["variants"].push_back({{"what", one.what},
                                {"output", one.folder.string()},
                                {"probability", one.variant.probability},
                                {"difficulty", one.variant.difficulty},
                                {"parameters", parameters},
                                {"findings", findings}});
  }
  return json;
}

void PrintVariants(const std::vector<Completion>& all, bool keeps_tubes) {
  std::vector<std::vector<std::string>> rows;
  if (all.size() == 1) {
    rows = {{"what the images do not show", "value", "unit", "from"}};
    for (const patient::Parameter& parameter : all.front().parameters)
      rows.push_back({parameter.name, FormatParameter(parameter), parameter.unit, parameter.source});
  } else {
    rows = {{"folder", "of people [%]"}};
    for (const anatomy::VariationShare& share : all.front().variant.shares)
      rows.front().push_back(share.name);
    for (const Completion& one : all) {
      rows.push_back({one.folder.filename().string(), ShownNumber(100 * one.variant.probability, 3)});
      for (const anatomy::VariationShare& share : one.variant.shares) rows.back().push_back(share.value);
    }
  }
  host::PrintTable(rows);
  PrintLine();
  double sum = 0;
  for (const Completion& one : all) {
    sum += one.variant.probability;
    for (const anatomy::LintFinding& finding : one.findings) {
      PrintLine(one.folder.string() + ": " + finding.code + "  " + finding.where);
      PrintLine("    " + host::TranslateComposed(finding.text));
    }
  }
  if (keeps_tubes) {
    Say("Ducts and arteries are seen in the images and stay as they are: only the rest was set.\n");
  } else {
    Say("{1} people in a hundred are like {2}, by the series named and as if they were independent.\n",
        ShownNumber(100 * sum, 3),
        all.size() == 1 ? host::Translate("this one") : host::Translate("one of these"));
  }
  Say("Nobody knows it of this patient: rehearse more than one.\n");
  std::string folders;
  for (const Completion& one : all) folders += (folders.empty() ? "" : ", ") + one.folder.string();
  Say("Wrote {1}\n", folders);
}

base::Status Complete(const CompleteArguments& arguments, Outcome& outcome) {
  const auto settings = ParseSettings(arguments.settings);
  if (!settings) return settings.error();
  for (const anatomy::ParameterSetting& setting : *settings) {
    const std::string& name = setting.first;
    if (anatomy::IsUnseenParameter(name)) continue;
    const auto rules = anatomy::ParameterRules();
    const bool is_known =
        std::any_of(rules.begin(), rules.end(), [&](const auto& rule) { return rule.name == name; });
    // an unknown name is refused where names are listed
    if (is_known)
      return base::Error{base::ErrorCode::kUsage, name + " is seen in the images: it is the patient's own"};
  }
  const auto patient = files::ReadPatient(arguments.patient);
  if (!patient) return patient.error();
  auto planned = Plan(arguments, *settings);
  if (!planned) return planned.error();
  for (Completion& one : *planned) {
    const auto completed = anatomy::CompletePatient(*patient, one.what, one.variant, one.parameters);
    if (!completed) return completed.error();
    one.findings = anatomy::LintPatient(*completed).findings;
    outcome.has_finding = outcome.has_finding || !one.findings.empty();
    std::error_code ignored;
    fs::create_directories(one.folder.parent_path(), ignored);
    if (const auto written = files::WritePatient(one.folder, *completed); !written) return written;
  }
  const bool keeps_tubes = anatomy::HasSeenTubes(*patient);
  if (arguments.is_json) {
    PrintJson(MakeVariantsJson(*planned, keeps_tubes));
  } else {
    PrintVariants(*planned, keeps_tubes);
  }
  return {};
}

}  // namespace

void AddAnatomyCompleteCommand(CLI::App& anatomy, Outcome& outcome) {
  CLI::App* complete = anatomy.add_subcommand(
      "complete", "Set what images do not show: ducts, arteries, wall, adhesions, stones");
  auto arguments = std::make_shared<CompleteArguments>();
  complete->add_option("patient", arguments->patient, "Patient folder, as from-labels writes it")
      ->required()
      ->type_name("PATIENT");
  complete
      ->add_option("-o,--output", arguments->output,
                   "Patient folder to write; with --ten-likely, the folder for them: 01, 02, ... 10")
      ->required()
      ->type_name("PATIENT");
  CLI::Option* likely = complete->add_flag("--most-likely", arguments->is_likely,
                                           "The most common variation of each (this is the default)");
  CLI::Option* ten =
      complete->add_flag("--ten-likely", arguments->is_ten, "The ten most likely combinations");
  CLI::Option* worst = complete->add_flag(
      "--worst", arguments->is_worst,
      "The hardest combination that enough people have (--at-least), with lengths, diameters, wall and "
      "stones\n"
      "at the harder end of the central 95 %, adhesions and fibrosis at half of their scale");
  CLI::Option* seed = complete->add_option("--seed", arguments->seed, "Draw all of it from the distributions")
                          ->type_name("N");
  complete
      ->add_option("--at-least", arguments->at_least_percent,
                   "How many people have the worst plausible combination [%]")
      ->check(CLI::Range(0.0, 100.0))
      ->needs(worst)
      ->capture_default_str()
      ->type_name("PERCENT");
  CLI::Option* const ways[] = {likely, ten, worst, seed};
  for (CLI::Option* one : ways) {
    for (CLI::Option* other : ways)
      if (one != other) one->excludes(other);
  }
  complete
      ->add_option("--set", arguments->settings,
                   "What is known, as from a cholangiogram, name=value; may be given several times")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  AddJsonFlag(
      *complete, arguments->is_json,
      "Machine-readable: {\"variants\": [{what, output, probability, difficulty, parameters, findings}]}");
  complete->footer(
      "Names and distributions: trocar anatomy generate --list. The patient's file keeps each value with its "
      "source\n"
      "and, where it is a variation, how many people have it. Exit status 1 where the check finds "
      "something.\n"
      "Examples: trocar anatomy complete out/patient --ten-likely -o out/ten\n"
      "          trocar anatomy complete out/patient --worst -o out/worst\n"
      "          trocar anatomy complete out/patient --set cystic_duct_insertion=low -o out/low");
  complete->callback([arguments, &outcome] { outcome.status = Complete(*arguments, outcome); });
}

}  // namespace trocar::cli
