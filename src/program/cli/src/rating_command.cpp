// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "attempt_page.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "pseudonym_option.h"
#include "trocar/host/safe_file.h"
#include "trocar/report/rating.h"

namespace trocar::cli {

using host::PrintLine;
using host::Say;
using host::Translate;

namespace {

using nlohmann::ordered_json;

struct FormArguments {
  std::string form, output;
};

base::Status WriteForm(const FormArguments& arguments) {
  const auto form = report::FindRatingForm(arguments.form);
  if (!form.ok()) return form.error();
  if (arguments.output.empty()) {
    PrintLine(Translate(form->name));
    PrintLine(Translate(form->about));
    for (const report::RatingItem& item : form->items) {
      PrintLine();
      PrintLine("  " + item.key + "=1..5   " + Translate(item.name));
      PrintLine("    1 " + Translate(item.lowest));
      PrintLine("    3 " + Translate(item.middle));
      PrintLine("    5 " + Translate(item.highest));
    }
    Say("\nSource: {1}\n", form->source);
    return {};
  }
  const auto kind = FindReportKind(arguments.output);
  if (!kind.ok() || *kind == ReportKind::kCsv || *kind == ReportKind::kJson)
    return base::Error{base::ErrorCode::kUsage, "a form is written to .html or .pdf"};
  const report::Document sheet = report::MakeRatingSheet(*form);
  const base::Status written = host::WriteFile(
      arguments.output, *kind == ReportKind::kPdf ? report::FormatPdf(sheet) : report::FormatHtml(sheet));
  if (written.ok()) Say("Wrote {1}, to be printed\n", arguments.output);
  return written;
}

struct EnterArguments {
  report::Rating rating;
  std::vector<std::string> points;
  std::string output;
};

base::Status EnterRating(EnterArguments arguments) {
  const auto form = report::FindRatingForm(arguments.rating.form);
  if (!form.ok()) return form.error();
  auto points = report::ParsePoints(*form, arguments.points);
  if (!points.ok()) return points.error();
  arguments.rating.form = form->key;
  arguments.rating.points = std::move(*points);
  arguments.rating.attempt = std::filesystem::path(arguments.rating.attempt).filename().string();
  const std::string text = report::FormatRating(arguments.rating);
  if (arguments.output.empty()) {
    host::PrintLines(text);
    return {};
  }
  if (const auto written = host::WriteFile(arguments.output, text); !written.ok()) return written;
  Say("{1}: {2} of {3} points, in {4}\n", Translate(form->name), arguments.rating.Sum(),
      form->items.size() * report::kMostPoints, arguments.output);
  return {};
}

struct AgreementArguments {
  std::vector<std::string> files;
  double confidence = 95;  // [%]
  bool is_json = false;
};

ordered_json IccJson(const report::Icc& icc) {
  return {{"value", icc.value}, {"low", icc.low}, {"high", icc.high}};
}

void PrintAgreement(const report::RatingForm& form, const report::FormAgreement& agreement,
                    double confidence) {
  Say("{1}: {2} raters of {3} attempts; interval of {4} %\n\n", Translate(form.name), agreement.raters.size(),
      agreement.attempts.size(), host::ShownNumber(confidence, 3));
  std::vector<std::vector<std::string>> rows = {
      {"of", "ICC(2,1)", "interval", "ICC(2,k)", "interval", "ICC(3,1)", "interval", "one rater agrees"}};
  const auto number = [](double value) { return host::ShownFixed(value, 2); };
  const auto interval = [&](const report::Icc& icc) {
    return host::TranslateWith("{1} to {2}", {number(icc.low), number(icc.high)});
  };
  for (const auto& [of, icc] : agreement.of) {
    rows.push_back({of, number(icc.two_random.value), interval(icc.two_random),
                    number(icc.two_random_mean.value), interval(icc.two_random_mean),
                    number(icc.three_fixed.value), interval(icc.three_fixed),
                    Translate(report::DescribeAgreement(icc.two_random.value))});
  }
  host::PrintTable(rows);
  Say("\nICC(2,1): one rater, of any; ICC(2,k): the mean of these many; ICC(3,1): one of these raters, who "
      "may differ by a constant.\n"
      "Items whose ratings do not vary are left out. Words: Koo and Li 2016. Judge by the interval, not the "
      "value alone.\n");
}

base::Status CompareRatings(const AgreementArguments& arguments) {
  std::vector<report::Rating> ratings;
  for (const std::string& file : arguments.files) {
    auto rating = report::ReadRating(file);
    if (!rating.ok()) return rating.error();
    ratings.push_back(std::move(*rating));
  }
  const auto form = report::FindRatingForm(ratings.front().form);
  if (!form.ok()) return form.error();
  const auto agreement = report::CompareRatings(*form, ratings, arguments.confidence / 100);
  if (!agreement.ok()) return agreement.error();
  if (!arguments.is_json) {
    PrintAgreement(*form, *agreement, arguments.confidence);
    return {};
  }
  ordered_json json = {{"form", form->key},
                       {"attempts", agreement->attempts},
                       {"raters", agreement->raters},
                       {"confidence", arguments.confidence / 100},
                       {"of", ordered_json::object()}};
  for (const auto& [of, icc] : agreement->of) {
    json["of"][of] = {{"icc_1_1", IccJson(icc.one_random)},      {"icc_2_1", IccJson(icc.two_random)},
                      {"icc_3_1", IccJson(icc.three_fixed)},     {"icc_1_k", IccJson(icc.one_random_mean)},
                      {"icc_2_k", IccJson(icc.two_random_mean)}, {"icc_3_k", IccJson(icc.three_fixed_mean)}};
  }
  PrintJson(json);
  return {};
}

void AddForm(CLI::App& rating, Outcome& outcome) {
  CLI::App* command = rating.add_subcommand("form", "Show a form, or write it to be printed");
  auto arguments = std::make_shared<FormArguments>();
  command->add_option("form", arguments->form, "goals, osats, or a file of your own")
      ->required()
      ->type_name("FORM");
  command->add_option("-o,--output", arguments->output, "To .html or .pdf; none: show its items")
      ->type_name("FILE");
  command->callback([arguments, &outcome] { outcome.status = WriteForm(*arguments); });
}

void AddEnter(CLI::App& rating, Outcome& outcome) {
  CLI::App* command = rating.add_subcommand("enter", "Keep what somebody gave an attempt, as JSON");
  auto arguments = std::make_shared<EnterArguments>();
  command->add_option("form", arguments->rating.form, "goals, osats, or a file of your own")
      ->required()
      ->type_name("FORM");
  command->add_option("points", arguments->points, "Points of every item, such as depth_perception=4")
      ->required()
      ->type_name("ITEM=1..5");
  command->add_option("--attempt", arguments->rating.attempt, "What was rated: the recording")
      ->required()
      ->type_name("FILE");
  AddPseudonymOption(*command, "--rater", arguments->rating.rater, "Pseudonym of the rater")->required();
  command->add_option("--date", arguments->rating.rated, "When, such as 2026-11-24T22:50:20+01:00")
      ->type_name("DATE");
  command->add_option("--remarks", arguments->rating.remarks, "Free text")->type_name("TEXT");
  command->add_option("-o,--output", arguments->output, "File to write; none: print it")->type_name("FILE");
  command->callback([arguments, &outcome] { outcome.status = EnterRating(*arguments); });
}

void AddAgreement(CLI::App& rating, Outcome& outcome) {
  CLI::App* command = rating.add_subcommand(
      "agreement", "Say how well raters agree: intraclass correlation of Shrout and Fleiss");
  auto arguments = std::make_shared<AgreementArguments>();
  command->add_option("files", arguments->files, "Ratings of one form: every rater of every attempt")
      ->required()
      ->type_name("FILE");
  command->add_option("--confidence", arguments->confidence, "Of the intervals [%]")
      ->check(CLI::Range(50.0, 99.9))
      ->type_name("P")
      ->capture_default_str();
  AddJsonFlag(*command, arguments->is_json, "Machine-readable, with all six coefficients");
  command->callback([arguments, &outcome] { outcome.status = CompareRatings(*arguments); });
}

}  // namespace

void AddRatingCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "rating");
  command->require_subcommand(1);
  AddForm(*command, outcome);
  AddEnter(*command, outcome);
  AddAgreement(*command, outcome);
  command->footer(
      "Examples:\n"
      "  trocar rating form goals -o goals.pdf\n"
      "  trocar rating enter goals depth_perception=4 bimanual_dexterity=3 efficiency=3 tissue_handling=4 "
      "autonomy=5 \\\n"
      "    --attempt attempt.trocar --rater I-2 -o rating.json\n"
      "  trocar rating agreement ratings/*.json");
}

}  // namespace trocar::cli
