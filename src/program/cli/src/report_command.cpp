// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "attempt_page.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "group_values.h"
#include "pseudonym_option.h"
#include "trocar/assessment/learning.h"
#include "trocar/host/safe_file.h"
#include "trocar/report/report_files.h"

namespace trocar::cli {
namespace {

struct ReportArguments {
  std::vector<std::string> files;
  std::string output, person, group;
  StoreOptions store;
  int threads = 1;
  bool is_dictionary = false;
};

base::Status WriteDictionary(const ReportArguments& arguments) {
  const std::string text = report::FormatDictionaryCsv();
  if (!arguments.output.empty()) return host::WriteFile(arguments.output, text);
  host::PrintLines(text);
  return {};
}

/// Curves' fits, and the sum of failures of each task: not passed, or not completed where there are no thresholds.
void FillLearning(report::TraineeReport& report) {
  for (report::LearningCurve& curve : report.curves) {
    const auto fit = assessment::FitLearningCurve(curve.values);
    if (fit.ok()) curve.fit = report::CurveFit{fit->plateau, fit->gain, fit->rate};
  }
  std::map<std::string, std::vector<bool>> failed;
  for (const report::AttemptRow& row : report.attempts)
    failed[row.task].push_back(!row.is_passed.value_or(row.is_completed));
  for (const auto& [task, failures] : failed) {
    const auto cusum = assessment::CalcCusum(failures);
    if (!cusum.ok()) continue;
    report.cusums.push_back({task, cusum->values, cusum->h0, cusum->h1,
                             std::string(assessment::VerdictSentence(cusum->verdict))});
  }
}

base::Status Report(ReportArguments arguments) {
  if (arguments.is_dictionary) return WriteDictionary(arguments);
  if (arguments.files.empty())
    return base::Error{base::ErrorCode::kUsage, "name a recording, or several of one person"};
  if (arguments.output.empty()) {
    arguments.output = arguments.files.size() == 1
                           ? std::filesystem::path(arguments.files[0]).replace_extension(".html").string()
                           : "trainee.html";
  }
  if (!arguments.group.empty() && arguments.files.size() > 1)
    return base::Error{base::ErrorCode::kUsage, "--group compares one attempt: name one recording"};
  // a wrong ending is told before minutes of replaying
  if (const auto kind = FindReportKind(arguments.output); !kind.ok()) return kind.error();
  std::vector<report::AttemptReport> reports;
  for (const std::string& file : arguments.files) {
    auto made = ReportRecording(file, arguments.person, arguments.threads);
    if (!made.ok()) return made.error();
    reports.push_back(std::move(*made));
  }
  std::stable_sort(reports.begin(), reports.end(),
                   [](const report::AttemptReport& a, const report::AttemptReport& b) {
                     return a.facts.started < b.facts.started;
                   });
  if (!arguments.group.empty()) {
    store::StoreSettings settings;
    settings.only_look = true;
    auto session = OpenSession(arguments.store, settings);
    if (!session.ok()) return session.error();
    if (auto compared = CompareWithGroup(reports[0], *session, arguments.group); !compared.ok())
      return compared;
  }
  base::Status written;
  if (reports.size() == 1) {
    written = WriteReport(reports[0], arguments.output);
  } else {
    report::TraineeReport trainee = report::MakeTraineeReport(reports);
    FillLearning(trainee);
    written = WriteReport(trainee, arguments.output);
  }
  if (!written.ok()) return written;
  if (reports.size() == 1) host::PrintLine(host::TranslateComposed(reports[0].outcome));
  host::Say("Wrote {1}\n", arguments.output);
  return {};
}

}  // namespace

void AddReportCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "report");
  auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("files", arguments->files,
                   "A recording; or several of one person, for a report of the trainee")
      ->type_name("FILE");
  command
      ->add_option("-o,--output", arguments->output,
                   "What to write: .html (one file, no network), .pdf, .csv or .json [the recording's name "
                   "with .html]")
      ->type_name("FILE");
  AddPseudonymOption(*command, "--person", arguments->person, "Pseudonym of whose attempt it is");
  command
      ->add_option(
          "--group", arguments->group,
          "Compare with this group's people in the radar, where at least five have completed the task")
      ->type_name("GROUP");
  command
      ->add_option("--store", arguments->store.url,
                   "Where the group is: SQLite file or postgresql://... (else TROCAR_STORE, else your own)")
      ->type_name("URL");
  command
      ->add_option("--as", arguments->store.viewer,
                   "Ask the store as this person: see what their role allows")
      ->type_name("PSEUDONYM");
  AddThreadsOption(*command, arguments->threads, "Of the solver; the report is the same for any number");
  command->add_flag("--dictionary", arguments->is_dictionary,
                    "Only write what every column of CSV and field of JSON means, as CSV");
  command->footer(
      "Several recordings give the trainee's report: attempts, curves, what to practise.\n"
      "Examples:\n"
      "  trocar report attempt.trocar -o attempt.pdf --person T-7F3K2Q\n"
      "  trocar report attempt.trocar --group evening\n"
      "  trocar report monday.trocar tuesday.trocar --person T-7F3K2Q -o trainee.html");
  command->callback([arguments, &outcome] { outcome.status = Report(*arguments); });
}

}  // namespace trocar::cli
