// SPDX-License-Identifier: Apache-2.0
#include "play_operation.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "attempt_recording.h"
#include "console.h"
#include "part_folder.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/cholecystectomy/operation_end.h"
#include "trocar/host/clock.h"
#include "trocar/host/json.h"
#include "trocar/host/threads.h"
#include "trocar/host/translate.h"
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

ordered_json OperationErrorJson(const cholecystectomy::ErrorEntry& entry) {
  constexpr const char* kHands[] = {"left", "right"};
  ordered_json json = {{"error", cholecystectomy::NameOf(entry.error)},
                       {"severity", cholecystectomy::NameOf(cholecystectomy::SeverityOf(entry.error))},
                       {"time_s", entry.time},
                       {"at_mm", {1e3 * entry.place.x, 1e3 * entry.place.y, 1e3 * entry.place.z}}};
  if (entry.hand >= 0 && entry.hand < instrument::kHandCount) json["hand"] = kHands[entry.hand];
  return json;
}

cholecystectomy::OperationEnd EndOf(const OperationResult& result, const std::string& bail_out) {
  return cholecystectomy::JudgeEnd(result.is_completed, !bail_out.empty(), result.errors, result.injuries);
}

/// \param bail_out  why it was ended early; "" where it was not
ordered_json MakeJson(const OperationResult& result, const Run& run, const std::string& bail_out) {
  ordered_json json = {{"completed", result.is_completed},
                       {"end", cholecystectomy::NameOf(EndOf(result, bail_out))},
                       {"bail_out", bail_out},
                       {"critical_view", result.was_critical_view_achieved},
                       {"critical_errors", ordered_json::array()},
                       {"errors", ordered_json::array()}};
  for (const cholecystectomy::ErrorEntry& entry : result.errors.Entries()) {
    const bool is_critical = cholecystectomy::SeverityOf(entry.error) == cholecystectomy::Severity::kCritical;
    json[is_critical ? "critical_errors" : "errors"].push_back(OperationErrorJson(entry));
  }
  json.update({{"blood_ml", Left(result, surgery::Fluid::kBlood)},
               {"bile_ml", Left(result, surgery::Fluid::kBile)},
               {"tick_p99_ms", base::CalcPercentile(run.tick_ms, 0.99)},
               {"cut_tick_max_ms", run.cut_tick_max_ms},
               {"hash", base::HashText(run.hash)},
               {"time_s", run.seconds},
               {"phase", cholecystectomy::NameOf(result.phase)},
               {"strasberg", Translate(cholecystectomy::StrasbergName(result.injuries.strasberg))},
               {"right_liver_without_blood", result.injuries.is_right_liver_without_blood},
               {"bed_blood_ml", kMillilitre * result.bed_blood},
               {"stones",
                {{"all", result.stones.all},
                 {"inside", result.stones.inside},
                 {"spilled_not_retrieved", result.stones.spilled},
                 {"in_bag", result.stones.in_bag},
                 {"aspirated", result.stones.aspirated},
                 {"taken_out", result.stones.taken_out}}},
               {"cleared_share", result.facts.cleared_share},
               {"detached_share", result.facts.detached_share},
               {"structures_entering", result.facts.structures_entering}});
  return json;
}

void PrintOperationResult(const scene::Scene& scene, const OperationResult& result, const Run& run,
                          const std::string& bail_out) {
  Say(result.is_completed ? "{1}: completed after {2} s\n" : "{1}: not completed after {2} s\n",
      host::TranslateComposed(scene.name), ShownNumber(run.seconds, 4));
  if (!bail_out.empty()) {
    Say("Ended early: {1}.\n", Translate(bail_out));
    Say(EndOf(result, bail_out) == cholecystectomy::OperationEnd::kConversion
            ? "Nothing that must stay was harmed: it counts as a conversion, not as a failure.\n"
            : "It came too late to count as a conversion: see the errors.\n");
  }
  Say(result.was_critical_view_achieved ? "Critical view of safety: achieved\n"
                                        : "Critical view of safety: not achieved\n");
  if (!result.was_critical_view_achieved) {
    for (const std::string& reason : cholecystectomy::ExplainCriticalView(result.facts, result.critical_view))
      host::PrintLine("  " + host::TranslateComposed(reason));
  }
  for (std::size_t i = 0; i < cholecystectomy::kOperationErrorCount; ++i) {
    const auto error = static_cast<cholecystectomy::OperationError>(i);
    const std::size_t count = result.errors.Count(error);
    if (count == 0) continue;
    host::PrintLine("  " + std::to_string(count) + " x " + ShownName(cholecystectomy::NameOf(error)) + " (" +
                    Translate(cholecystectomy::NameOf(cholecystectomy::SeverityOf(error))) +
                    "): " + Translate(cholecystectomy::ExplanationOf(error)));
  }
  Say("Blood {1} mL, bile {2} mL; injury by Strasberg: {3}\n",
      ShownNumber(Left(result, surgery::Fluid::kBlood), 3),
      ShownNumber(Left(result, surgery::Fluid::kBile), 3),
      Translate(cholecystectomy::StrasbergName(result.injuries.strasberg)));
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

std::string DescribeProgress(const Snapshot& now, std::string_view doing) {
  return host::TranslateWith(
      "{1} s, {2}: fat cleared {3} %, bed free {4} %, errors {5}",
      {ShownNumber(now.time, 4), Translate(doing), ShownNumber(100 * now.operation.facts.cleared_share, 3),
       ShownNumber(100 * now.operation.facts.detached_share, 3), std::to_string(now.operation.errors)});
}

/// How far an operation is, roughly: by what it divides [-].
double Share(const Snapshot& now) {
  return now.operation.is_completed
             ? 1.0
             : 0.45 * now.operation.facts.cleared_share + 0.45 * now.operation.facts.detached_share;
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
    progress.SetLabel(DescribeProgress(now, surgeon.Doing()));
    progress.Show(Share(now));
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
    PrintJson(MakeJson(result, run, bail_out));
  } else {
    PrintOperationResult(*scene, result, run, bail_out);
  }
  return {};
}

}  // namespace trocar::cli
