// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "attempt_recording.h"
#include "command.h"
#include "common_options.h"
#include "console.h"
#include "igtl_option.h"
#include "live_input.h"
#include "own_json.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/state_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/log.h"
#include "trocar/host/threads.h"
#include "trocar/net/igtl_server.h"
#include "trocar/simulation/simulation.h"
#include "trocar/tissue_cuda/gpu_or_cpu_solver.h"

namespace trocar::cli {

using host::Say;
using host::ShownNumber;

namespace {

struct SimulateOptions {
  std::string scene;
  std::string patient;        // in place of the scene's
  std::string device;         // in place of the script's hands
  std::string save, restore;  // files of states, or empty
  std::string record;         // file of a recording, or empty
  HapticOptions haptics;
  int igtl_port = -1;  // -1: nobody looks on
  int ticks = 0;
  std::uint64_t seed = 0;
  bool has_seed = false;
  int threads = 1;
  bool uses_gpu = false;
  bool is_json = false;
};

struct StageTimes {
  std::string name;
  double median_ms = 0, p99_ms = 0;
};

struct SimulateReport {
  std::string hash;
  std::uint64_t ticks = 0;
  double residual = 0;  // after the last tick
  std::vector<StageTimes> stages;
  double tick_p99_ms = 0;
  double max_force_n = 0;  // largest reaction on either instrument in any tick
  std::string gpu;         // name; or why it was not used to the end
  std::optional<session::HapticSummary> haptics;
};

/// One line in the tick in which the processor takes over from the GPU.
void WarnOnce(const simulation::Simulation& simulation, std::string& said) {
  if (!said.empty() || simulation.DeviceError() == nullptr) return;
  said = simulation.DeviceError()->Text();
  host::Log(host::LogLevel::kWarning, said);
}

base::Result<SimulateReport> Simulate(const SimulateOptions& options) {
  if (!options.record.empty() && options.uses_gpu) {
    return base::Error{base::ErrorCode::kUsage,
                       "--record goes without --gpu, whose bits another computer does not repeat"};
  }
  base::Result<scene::Scene> read = files::ReadScene(options.scene, options.patient);
  if (!read) return read.error();
  auto scene = std::make_shared<scene::Scene>(std::move(read).value());
  if (options.has_seed) scene->seed = options.seed;
  simulation::Services services{.threads = host::UseThreads(options.threads), .now = host::NowNanoseconds};
  if (options.uses_gpu) services.make_device_solver = tissue_cuda::MakeGpuOrCpuSolver;
  base::Result<simulation::Simulation> made = simulation::Simulation::Make(scene, services);
  if (!made) return made.error();
  simulation::Simulation simulation = std::move(made).value();
  if (!options.restore.empty()) {
    const auto restored = files::ReadStateFile(options.restore, simulation);
    if (!restored) return restored.error();
  }
  auto live = LiveInput::Open(options.device, *scene);
  if (!live) return live.error();

  std::unique_ptr<net::IgtlServer> server;
  if (options.igtl_port >= 0) {
    auto listening = ServeViewers(options.igtl_port, simulation);
    if (!listening) return listening.error();
    server = std::move(*listening);
  }

  if (const base::Status used = (*live)->UseHaptics(options.haptics, simulation); !used) return used.error();

  const std::string player = options.haptics.name.empty()
                                 ? (options.device.empty() ? std::string("script") : options.device)
                                 : options.haptics.name;
  auto recording = AttemptRecording::Start(
      options.record,
      Describe(record::Description::Kind::kScene, options.scene, options.patient, scene->seed, player),
      simulation);
  if (!recording) return recording.error();

  const auto count = static_cast<std::size_t>(options.ticks);
  std::array<std::vector<double>, simulation::kStageCount> stage_ms;
  for (auto& times : stage_ms) times.reserve(count);
  std::vector<double> tick_ms;
  tick_ms.reserve(count);
  SimulateReport report;
  host::ProgressBar progress("simulating", options.ticks);
  for (int tick = 0; tick < options.ticks; ++tick) {
    const scene::Input input = (*live)->For(simulation.GetSnapshot().tick + 1, simulation.GetSnapshot());
    const host::Stopwatch stopwatch;
    simulation.Step(input);
    (*live)->AfterStep(simulation);
    recording->Add(input, simulation);
    tick_ms.push_back(1e3 * stopwatch.Seconds());
    const simulation::Snapshot& snapshot = simulation.GetSnapshot();
    for (std::size_t i = 0; i < stage_ms.size(); ++i) stage_ms[i].push_back(1e3 * snapshot.stage_seconds[i]);
    for (const auto& instrument : snapshot.instruments) {
      report.max_force_n = std::max(report.max_force_n, math::Norm(instrument.force));
    }
    if (server != nullptr) server->Publish(snapshot);
    WarnOnce(simulation, report.gpu);
    progress.Show(tick + 1);
  }
  progress.Finish();
  if (const base::Status finished = recording->Finish(simulation); !finished) return finished.error();
  if (!options.save.empty()) {
    if (const base::Status saved = files::WriteStateFile(options.save, simulation); !saved)
      return saved.error();
  }
  if (const base::Status whole = (*live)->Check(); !whole) return whole.error();

  if (report.gpu.empty()) report.gpu = simulation.DeviceName();
  report.hash = base::HashText(simulation.Hash());
  report.ticks = simulation.GetSnapshot().tick;
  report.residual = simulation.GetSnapshot().residual;
  for (int i = 0; i < simulation::kStageCount; ++i) {
    const auto& times = stage_ms[static_cast<std::size_t>(i)];
    report.stages.push_back({std::string(simulation::StageName(static_cast<simulation::Stage>(i))),
                             base::CalcPercentile(times, 0.5), base::CalcPercentile(times, 0.99)});
  }
  report.tick_p99_ms = base::CalcPercentile(tick_ms, 0.99);
  if (const HapticInput* haptics = (*live)->Haptics(); haptics != nullptr) {
    report.haptics = haptics->Record().CalcSummary();
    if (const base::Status saved = haptics->SaveRecord(); !saved) return saved.error();
  }
  return report;
}

void PrintRunJson(const SimulateReport& report) {
  nlohmann::ordered_json json = {
      {"hash", report.hash}, {"ticks", report.ticks}, {"residual", report.residual}};
  json["stages"] = nlohmann::ordered_json::array();
  for (const StageTimes& stage : report.stages) {
    json["stages"].push_back(
        {{"name", stage.name}, {"median_ms", stage.median_ms}, {"p99_ms", stage.p99_ms}});
  }
  json["tick_p99_ms"] = report.tick_p99_ms;
  json["max_force_n"] = report.max_force_n;
  if (!report.gpu.empty()) json["gpu"] = report.gpu;
  if (report.haptics) {
    const std::string summary = session::FormatSummaryJson(*report.haptics);
    json["haptics"] = ParseOwnJson(summary);
  }
  PrintJson(json);
}

void PrintRun(const SimulateReport& report) {
  std::vector<std::vector<std::string>> rows = {{"stage", "median [ms]", "p99 [ms]"}};
  for (const StageTimes& stage : report.stages) {
    rows.push_back({ShownName(stage.name), ShownNumber(stage.median_ms, 3), ShownNumber(stage.p99_ms, 3)});
  }
  rows.push_back({host::Translate("whole tick"), "", ShownNumber(report.tick_p99_ms, 3)});
  host::PrintTable(rows);
  if (!report.gpu.empty()) Say("\nGPU: {1}\n", report.gpu);
  Say("\n{1} ticks, state hash {2}\n", report.ticks, report.hash);
  if (report.haptics) {
    for (const auto& [what, how] : session::DescribeSummary(*report.haptics))
      host::PrintLine(host::Translate(what) + ": " + host::TranslateComposed(how));
  }
  Say("residual after the last tick {1}, largest force on an instrument {2} N\n",
      ShownNumber(report.residual), ShownNumber(report.max_force_n));
}

}  // namespace

void AddSimulateCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "simulate");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("scene", options->scene, "Scene file (JSON), which names its patient and its script")
      ->required()
      ->type_name("FILE");
  command->add_option("--patient", options->patient, "Patient folder in place of the scene's")
      ->type_name("PATIENT");
  command->add_option("--ticks", options->ticks, "How many ticks, each scene.tick_seconds long (1/120 s)")
      ->required()
      ->check(CLI::Range(1, 10'000'000))
      ->type_name("N");
  CLI::Option* seed =
      command->add_option("--seed", options->seed, "In place of the scene's seed")->type_name("K");
  AddThreadsOption(*command, options->threads);
  AddDeviceOption(*command, options->device);
  command->add_option("--save", options->save, "Write the state after the last tick")->type_name("FILE");
  command
      ->add_option("--restore", options->restore,
                   "Go on from a state that was saved of the same scene, patient and seed")
      ->type_name("FILE");
  AddRecordOption(*command, options->record);
  AddIgtlOption(*command, options->igtl_port);
  AddHapticOptions(*command, options->haptics);
  command->add_flag("--gpu", options->uses_gpu,
                    "Solve on the GPU (single precision, so another hash); without one the processor does");
  AddJsonFlag(*command, options->is_json);
  command->footer(
      "The same scene, seed and ticks give the same hash, twice and with any number of threads.\n"
      "Example: trocar simulate scenes/demonstration.json --ticks 240 --seed 1 --threads 2 --json");
  command->callback([options, seed, &outcome] {
    options->has_seed = seed->count() > 0;
    const base::Result<SimulateReport> report = Simulate(*options);
    if (!report) {
      outcome.status = report.error();
      return;
    }
    options->is_json ? PrintRunJson(*report) : PrintRun(*report);
  });
}

}  // namespace trocar::cli
