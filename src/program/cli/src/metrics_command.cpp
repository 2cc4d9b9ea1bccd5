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

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "metric_text.h"
#include "own_json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/version.h"
#include "trocar/record/trace.h"
#include "trocar/training/attempt_metrics.h"
#include "trocar/training/kinematics_file.h"
#include "trocar/training/metric_definition.h"
#include "trocar/training/trace_file.h"
#include "validity_note.h"

namespace trocar::cli {

using host::Translate;

namespace {

using nlohmann::ordered_json;
using training::AttemptMetrics;
using training::AttemptTrace;

/// Of a trace that another program has written: an hour of operating [bytes].
constexpr std::size_t kMostTraceBytes = std::size_t{2} << 30;

struct MetricsArguments {
  std::string file, output, trace, kinematics;
  int threads = 1;
  bool is_json = false, is_csv = false, is_list = false, is_markdown = false, has_parts = false;
};

/// A trace and what it is of.
struct TracedFile {
  AttemptTrace trace;
  ordered_json of = ordered_json::object();
  bool has_tips_alone = false;  ///< nothing else was recorded: no shaft, force, view or event
};

base::Result<TracedFile> ReadTraceFile(const std::string& path) {
  const auto text = host::ReadFile(path, kMostTraceBytes);
  if (!text.ok()) return text.error();
  auto trace = training::ParseTraceJson(*text, path);
  if (!trace.ok()) return trace.error();
  return TracedFile{std::move(*trace), {{"trace", path}}};
}

base::Result<TracedFile> ReadKinematicsFile(const MetricsArguments& arguments) {
  const auto format = training::FindKinematicsFormat(arguments.kinematics);
  if (!format)
    return base::Error{base::ErrorCode::kUnknownName,
                       "no kinematics \"" + arguments.kinematics + "\"; there are jigsaws and compass"};
  const auto text = host::ReadFile(arguments.file, kMostTraceBytes);
  if (!text.ok()) return text.error();
  auto trace = training::ParseKinematics(*text, *format, arguments.file);
  if (!trace.ok()) return trace.error();
  return TracedFile{
      std::move(*trace), {{"kinematics", arguments.kinematics}, {"file", arguments.file}}, true};
}

base::Result<TracedFile> TraceAttempt(const MetricsArguments& arguments) {
  if (!arguments.kinematics.empty()) return ReadKinematicsFile(arguments);
  if (std::filesystem::path(arguments.file).extension() == ".json") return ReadTraceFile(arguments.file);
  auto recording = record::ReadRecording(arguments.file);
  if (!recording.ok()) return recording.error();
  const record::Description& d = recording->description;
  TracedFile traced;
  traced.of = {{"of", d.name},
               {"level", d.level},
               {"patient", d.patient},
               {"seed", d.seed},
               {"player", d.player},
               {"started", d.started},
               {"seconds", recording->Seconds()},
               {"finished", recording->ending.has_value()}};
  host::ProgressBar progress("replaying", 1.0);
  auto trace = record::TraceRecording(std::move(*recording), arguments.threads,
                                      [&](double share) { progress.Show(share); });
  progress.Finish();
  if (!trace.ok()) return trace.error();
  traced.trace = std::move(*trace);
  return traced;
}

std::string FormatMetricsFile(const TracedFile& traced, const AttemptMetrics& metrics) {
  ordered_json json = {{"format", "trocar-metrics"},
                       {"version", 1},
                       {"program", host::VersionText()},
                       {"disclaimer", training::MetricsDisclaimer()},
                       {"attempt", traced.of}};
  json["metrics"] = ParseOwnJson(training::FormatMetricsJson(metrics));
  return host::FormatJson(json, 2) + "\n";
}

std::string FormatWords(const TracedFile& traced, const AttemptMetrics& metrics, bool has_parts,
                        const training::Validity& validity) {
  std::string text, note;
  if (traced.of.contains("of")) {
    text += host::PrintableLine(host::TranslateWith(
                "{1}, played by {2}, {3} s", {traced.of["of"].get<std::string>(),
                                              host::TranslateComposed(traced.of["player"].get<std::string>()),
                                              host::ShownNumber(traced.trace.Seconds())})) +
            (traced.of["finished"] == true ? "" : Translate(" (the recording was not finished)")) + "\n\n";
    const std::string task = TaskKey(traced.of["of"].get<std::string>());
    note = FormatValidityNote(metrics, task, validity.FindTask(task)) + "\n";
  }
  return text + FormatMetricsText(metrics, has_parts) + "\n" + note +
         Translate(training::MetricsDisclaimer()) + ". " +
         Translate("trocar metrics --list says what each number is.") + "\n";
}

base::Status PutOut(const std::string& text, const std::string& output) {
  if (!output.empty()) return host::WriteFile(output, text);
  host::PrintLines(text);
  return {};
}

base::Status ListDefinitions(const MetricsArguments& arguments) {
  if (arguments.is_json) return PutOut(std::string(training::MetricDefinitionsJson()), arguments.output);
  if (arguments.is_markdown) return PutOut(training::FormatMetricDefinitionsPage(), arguments.output);
  std::vector<std::vector<std::string>> rows = {{"id", "name", "unit", "better", "evidence", "what it is"}};
  for (const training::MetricDefinition& d : training::MetricDefinitions()) {
    rows.push_back({d.id, Translate(d.name), d.shown_unit,
                    d.better == training::BetterWhen::kNeither ? "" : Translate(NameOf(d.better)),
                    Translate(NameOf(d.evidence)), Translate(d.about)});
  }
  return PutOut(host::FormatShownTable(rows), arguments.output);
}

base::Status MeasureAttempt(const MetricsArguments& arguments) {
  if (arguments.is_list) return ListDefinitions(arguments);
  if (arguments.file.empty())
    return base::Error{base::ErrorCode::kUsage, "name a recording, or --list to see what is measured"};
  auto traced = TraceAttempt(arguments);
  if (!traced.ok()) return traced.error();
  if (!arguments.trace.empty()) {
    const bool is_csv = std::filesystem::path(arguments.trace).extension() == ".csv";
    const std::string text =
        is_csv ? training::FormatTraceCsv(traced->trace) : training::FormatTraceJson(traced->trace);
    if (const auto status = host::WriteFile(arguments.trace, text); !status.ok()) return status;
  }
  auto metrics = training::CalcAttemptMetrics(traced->trace);
  if (!metrics.ok()) return metrics.error();
  if (traced->has_tips_alone) *metrics = training::KeepMetricsOfTips(std::move(*metrics));
  if (arguments.is_json) return PutOut(FormatMetricsFile(*traced, *metrics), arguments.output);
  if (arguments.is_csv) return PutOut(training::FormatMetricsCsv(*metrics), arguments.output);
  const auto validity = ReadValidity();
  if (!validity.ok()) return validity.error();
  return PutOut(FormatWords(*traced, *metrics, arguments.has_parts, *validity), arguments.output);
}

}  // namespace

void AddMetricsCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "metrics");
  auto arguments = std::make_shared<MetricsArguments>();
  command
      ->add_option("file", arguments->file,
                   "Recording, which is replayed, or a trace that --trace has written (.json)")
      ->type_name("FILE");
  auto* json =
      AddJsonFlag(*command, arguments->is_json, "Machine-readable, in SI units, with all phases and tools");
  command->add_flag("--csv", arguments->is_csv, "The same as lines of comma-separated values")
      ->excludes(json);
  command->add_flag("--parts", arguments->has_parts, "In words, also of each phase and of each tool");
  command->add_option("-o,--output", arguments->output, "Write it to a file")->type_name("FILE");
  command
      ->add_option("--trace", arguments->trace,
                   "Also write what is measured: every tick (.csv), or everything (.json)")
      ->type_name("FILE");
  command
      ->add_option("--kinematics", arguments->kinematics,
                   "The file is of people on a surgical robot, as a public data set writes it: jigsaws or "
                   "compass; then what "
                   "follows from the tips alone is measured")
      ->type_name("DATASET");
  auto* list = command->add_flag("--list", arguments->is_list,
                                 "Say what each metric is; with --json the definitions of docs/metrics.json");
  command->add_flag("--markdown", arguments->is_markdown, "With --list: as the page docs/metrics.md")
      ->needs(list);
  AddThreadsOption(*command, arguments->threads, "Of the replay; the numbers are the same for any number");
  command->footer(
      "The same recording gives the same numbers. They are training feedback, not certified assessment.\n"
      "Examples: trocar metrics attempt.trocar --parts\n"
      "          trocar metrics attempt.trocar --json -o metrics.json --trace trace.csv\n"
      "          trocar metrics Suturing_B001.txt --kinematics jigsaws");
  command->callback([arguments, &outcome] { outcome.status = MeasureAttempt(*arguments); });
}

}  // namespace trocar::cli
