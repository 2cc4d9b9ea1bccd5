// SPDX-License-Identifier: Apache-2.0
#include "play_operation.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "attempt_recording.h"
#include "console.h"
#include "part_folder.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"
#include "trocar/host/clock.h"
#include "trocar/host/json.h"
#include "trocar/host/threads.h"
#include "trocar/host/translate.h"
#include "trocar/procedures/operation_end.h"
#include "trocar/scene/procedure.h"
#include "trocar/session/input_sources.h"
#include "trocar/simulation/simulation.h"
#include "trocar/view/demo.h"

namespace trocar::cli {

using host::Say;
using host::ShownNumber;
using host::Translate;

namespace {

using nlohmann::ordered_json;
using simulation::OperationResult;
using simulation::Snapshot;

struct Run {
  std::vector<double> tick_ms;
  double cut_tick_max_ms = 0;
  std::uint32_t topology = 0;
  double seconds = 0;
  std::uint64_t hash = 0;

  void See(const Snapshot& now) {
    tick_ms.push_back(1e3 * now.tick_seconds);
    if (now.operation.topology.version != topology && now.tick > 1)
      cut_tick_max_ms = std::max(cut_tick_max_ms, tick_ms.back());
    topology = now.operation.topology.version;
    seconds = now.time;
  }
};

double Left(const OperationResult& result, surgery::Fluid fluid) {
  return kMillilitre * result.fluids.fluids[static_cast<std::size_t>(fluid)].left;
}

ordered_json OperationErrorJson(const surgery::ErrorEntry& entry, const surgery::ErrorRow& row) {
  constexpr const char* kHands[] = {"left", "right"};
  ordered_json json = {{"error", row.name},
                       {"severity", surgery::NameOf(row.severity)},
                       {"time_s", entry.time},
                       {"at_mm", {1e3 * entry.place.x, 1e3 * entry.place.y, 1e3 * entry.place.z}}};
  if (entry.hand >= 0 && entry.hand < instrument::kHandCount) json["hand"] = kHands[entry.hand];
  return json;
}

procedures::OperationEnd EndOf(const OperationResult& result, const std::string& bail_out) {
  return procedures::JudgeEnd(result, !bail_out.empty());
}

/// Of a class of injuries as it is shown; "" where the finding is a plain yes or no.
std::string ShownClass(const scene::Finding& finding) {
  const auto* text = std::get_if<std::string_view>(&finding.value);
  return text == nullptr ? "" : Translate(*text);
}

/// \param bail_out  why it was ended early; "" where it was not
ordered_json MakeJson(const scene::Scene& scene, const OperationResult& result, const Run& run,
                      const std::string& bail_out) {
  const scene::Procedure* procedure = scene::ProcedureOf(scene);
  const scene::ProcedureResult& judged = result.procedure;
  ordered_json json = {{"completed", result.is_completed},
                       {"end", procedures::NameOf(EndOf(result, bail_out))},
                       {"bail_out", bail_out},
                       {"critical_view", judged.was_view_achieved},
                       {"critical_errors", ordered_json::array()},
                       {"errors", ordered_json::array()}};
  for (const surgery::ErrorEntry& entry : judged.errors.Entries()) {
    const surgery::ErrorRow& row = judged.errors.RowOf(entry);
    const bool is_critical = row.severity == surgery::Severity::kCritical;
    json[is_critical ? "critical_errors" : "errors"].push_back(OperationErrorJson(entry, row));
  }
  json.update({{"blood_ml", Left(result, surgery::Fluid::kBlood)},
               {"bile_ml", Left(result, surgery::Fluid::kBile)},
               {"tick_p99_ms", base::CalcPercentile(run.tick_ms, 0.99)},
               {"cut_tick_max_ms", run.cut_tick_max_ms},
               {"hash", base::HashText(run.hash)},
               {"time_s", run.seconds},
               {"phase", scene::PhaseName(procedure, judged.now.phase)}});
  for (const scene::Finding& finding : judged.findings) {
    ordered_json& value = json[std::string(finding.name)];
    if (const bool* is_there = std::get_if<bool>(&finding.value)) {
      value = *is_there;
    } else {
      value = ShownClass(finding);
    }
  }
  json.update({{"bed_blood_ml", kMillilitre * result.bed_blood},
               {"stones",
                {{"all", result.stones.all},
                 {"inside", result.stones.inside},
                 {"spilled_not_retrieved", result.stones.spilled},
                 {"in_bag", result.stones.in_bag},
                 {"aspirated", result.stones.aspirated},
                 {"taken_out", result.stones.taken_out}}}});
  for (std::size_t row = 0; procedure != nullptr && row < procedure->measures.size(); ++row) {
    const scene::MeasureRow& measure = procedure->measures[row];
    const double value = judged.now.Measure(row);
    ordered_json& entry = json[std::string(measure.name)];
    if (measure.is_share) {
      entry = value;
    } else {
      entry = std::lround(value);
    }
  }
  return json;
}

void PrintOperationResult(const scene::Scene& scene, const OperationResult& result, const Run& run,
                          const std::string& bail_out) {
  Say(result.is_completed ? "{1}: completed after {2} s\n" : "{1}: not completed after {2} s\n",
      host::TranslateComposed(scene.name), ShownNumber(run.seconds, 4));
  if (!bail_out.empty()) {
    Say("Ended early: {1}.\n", Translate(bail_out));
    Say(EndOf(result, bail_out) == procedures::OperationEnd::kConversion
            ? "Nothing that must stay was harmed: it counts as a conversion, not as a failure.\n"
            : "It came too late to count as a conversion: see the errors.\n");
  }
  const scene::ProcedureResult& judged = result.procedure;
  Say(judged.was_view_achieved ? "Critical view of safety: achieved\n"
                               : "Critical view of safety: not achieved\n");
  if (!judged.was_view_achieved) {
    for (const std::string& reason : judged.missing) host::PrintLine("  " + host::TranslateComposed(reason));
  }
  for (std::size_t i = 0; i < judged.errors.Table().size(); ++i) {
    const surgery::ErrorRow& row = judged.errors.Table()[i];
    const std::size_t count = judged.errors.Count(surgery::ErrorId(static_cast<std::uint8_t>(i)));
    if (count == 0) continue;
    host::PrintLine("  " + std::to_string(count) + " x " + ShownName(row.name) + " (" +
                    Translate(surgery::NameOf(row.severity)) + "): " + Translate(row.explanation));
  }
  const auto injury = std::find_if(judged.findings.begin(), judged.findings.end(),
                                   [](const scene::Finding& finding) { return finding.name == "strasberg"; });
  Say("Blood {1} mL, bile {2} mL; injury by Strasberg: {3}\n",
      ShownNumber(Left(result, surgery::Fluid::kBlood), 3),
      ShownNumber(Left(result, surgery::Fluid::kBile), 3),
      injury == judged.findings.end() ? "-" : ShownClass(*injury));
  const surgery::StoneCount& stones = result.stones;
  if (stones.inside < stones.all) {
    Say("Of {1} stones {2} came out of the gallbladder; spilled and not retrieved: {3}\n", stones.all,
        stones.all - stones.inside, stones.spilled);
  }
  Say("Tick p99 {1} ms, longest tick with a cut {2} ms, state hash {3}\n",
      ShownNumber(base::CalcPercentile(run.tick_ms, 0.99), 3), ShownNumber(run.cut_tick_max_ms, 3),
      base::HashText(run.hash));
  Say("Training feedback, not certified assessment.\n");
}

std::string DescribeProgress(const scene::Scene& scene, const Snapshot& now, std::string_view doing) {
  const auto percent = [&](std::string_view measure) {
    return ShownNumber(100 * scene::MeasureOf(scene::ProcedureOf(scene), now.operation.procedure, measure),
                       3);
  };
  return host::TranslateWith("{1} s, {2}: fat cleared {3} %, bed free {4} %, errors {5}",
                             {ShownNumber(now.time, 4), Translate(doing), percent("cleared_share"),
                              percent("detached_share"), std::to_string(now.operation.errors)});
}

/// How far an operation is, roughly: by the mean of what its procedure measures as shares [-].
double Share(const scene::Scene& scene, const Snapshot& now) {
  if (now.operation.is_completed) return 1.0;
  const scene::Procedure* procedure = scene::ProcedureOf(scene);
  double sum = 0, count = 0;
  for (std::size_t row = 0; procedure != nullptr && row < procedure->measures.size(); ++row) {
    if (!procedure->measures[row].is_share) continue;
    sum += now.operation.procedure.Measure(row);
    ++count;
  }
  return count > 0 ? 0.9 * sum / count : 0.0;
}

}  // namespace

base::Status GoOn(const assessment::PlayFiles& files, double most_seconds, simulation::Simulation& simulation,
                  agent::Surgeon& surgeon) {
  if (files.restore.empty()) return {};
  if (auto restored = assessment::RestorePlay(files.restore, files.who, simulation, surgeon); !restored)
    return restored;
  const double time = simulation.GetSnapshot().time;
  if (time < most_seconds) return {};
  return base::Error{base::ErrorCode::kUsage,
                     "\"" + files.restore.string() + "\" stands at " + ShownNumber(time, 4) +
                         " s, and --seconds " + ShownNumber(most_seconds, 4) +
                         " counts from the attempt's start: give more seconds, or leave the option out"};
}

base::Status PlayOperation(std::shared_ptr<const scene::Scene> scene, agent::Surgeon& surgeon,
                           OperationPlay play) {
  Run run;
  OperationResult result;
  host::ProgressBar progress("operating", 1.0);
  const auto see = [&](const Snapshot& now) {
    run.See(now);
    if (now.tick % 60 != 0) return;
    progress.SetLabel(DescribeProgress(*scene, now, surgeon.Doing()));
    progress.Show(Share(*scene, now));
  };
  if (play.output.empty()) {
    auto made = simulation::Simulation::Make(
        scene, {.threads = host::UseThreads(play.threads), .now = host::NowNanoseconds});
    if (!made.ok()) return made.error();
    simulation::Simulation simulation = std::move(*made);
    if (auto restored = GoOn(play.files, play.most_seconds, simulation, surgeon); !restored) return restored;
    auto recording = AttemptRecording::Start(play.record, play.description, simulation);
    if (!recording.ok()) return recording.error();
    play.report.Start(simulation);
    while (!surgeon.HasFinished() && simulation.GetSnapshot().time < play.most_seconds) {
      const scene::Input input = surgeon.Act(simulation.GetSnapshot());
      simulation.Step(input);
      recording->Add(input, simulation);
      play.report.AfterStep(simulation, input);
      see(simulation.GetSnapshot());
    }
    if (auto finished = recording->Finish(simulation); !finished) return finished;
    if (auto written = play.report.Write(); !written) return written;
    if (!play.files.save.empty()) {
      if (auto saved = assessment::SavePlay(play.files.save, play.files.who, simulation, surgeon); !saved)
        return saved;
    }
    run.hash = simulation.Hash();
    result = *simulation.GetOperationResult();
  } else {
    view::DemoOptions options;
    options.width = play.width, options.height = play.height;
    options.threads = play.threads;
    PartFolder part(play.output);
    options.output_folder = part.Path();
    session::SurgeonSource source(surgeon);
    options.source = &source;
    options.is_until_end = true;
    options.duration = play.most_seconds;
    options.on_tick = see;
    play.report.Follow(options);
    const auto played = view::PlayDemonstration(scene, options);
    if (!played.ok()) return played.error();
    if (auto written = play.report.Write(played->pictures); !written) return written;
    if (auto status = part.Keep(); !status) return status;
    run.hash = played->state_hash;
    if (played->operation) result = *played->operation;
  }
  progress.Finish();
  const std::string bail_out(surgeon.BailOutReason());
  if (play.is_json) {
    PrintJson(MakeJson(*scene, result, run, bail_out));
  } else {
    PrintOperationResult(*scene, result, run, bail_out);
  }
  return {};
}

}  // namespace trocar::cli
