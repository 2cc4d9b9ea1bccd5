// SPDX-License-Identifier: Apache-2.0
// What recording costs a tick, how quickly a replay runs, seeks and branches.
#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "trocar/agent/surgeon.h"
#include "trocar/bench/benchmark.h"
#include "trocar/core/partial_path.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/device/ports.h"
#include "trocar/record/recorder.h"
#include "trocar/record/replay.h"
#include "trocar/scene/scene.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/session/runner.h"

namespace trocar::bench {
namespace {

using simulation::Simulation;

constexpr double kSeconds = 12;         // of the operation that is recorded
constexpr double kHapticSeconds = 4;    // that the 1 kHz loop is watched
constexpr double kIndexSeconds = 3;     // as the window keeps it
constexpr double kVisitSeconds = 0.75;  // as the replay window keeps it

struct Played {
  std::shared_ptr<const simulation::SimulationModel> model;
  std::vector<scene::Input> inputs;
  std::uint64_t hash = 0;
  double tick_seconds = 0;
};

core::Result<Played> PlayExpert(int threads) {
  auto scene = scene::FindOperation("cholecystectomy", {}, 1);
  if (!scene) return scene.error();
  const auto shared = std::make_shared<const scene::Scene>(std::move(**scene));
  Played played;
  auto model = simulation::MakeSimulationModel(shared, threads);
  if (!model) return model.error();
  played.model = *model;
  played.tick_seconds = shared->tick_seconds;
  auto simulation = Simulation::Make(played.model, threads);
  auto surgeon = agent::MakeSurgeon("expert", shared, 1);
  if (!simulation) return simulation.error();
  if (!surgeon) return surgeon.error();
  while (simulation->GetSnapshot().time < kSeconds) {
    played.inputs.push_back((*surgeon)->Act(simulation->GetSnapshot()));
    simulation->Step(played.inputs.back());
  }
  played.hash = simulation->Hash();
  return played;
}

record::Description Describe() {
  record::Description description;
  description.kind = record::Description::Kind::kOperation;
  description.name = "cholecystectomy";
  description.seed = 1;
  description.player = "a benchmark";
  return description;
}

/// Wall time of all ticks [s]. \param path  empty: nothing is recorded
core::Result<double> Step(const Played& played, int threads, const std::filesystem::path& path) {
  auto simulation = Simulation::Make(played.model, threads);
  if (!simulation) return simulation.error();
  std::unique_ptr<record::Recorder> recorder;
  if (!path.empty()) {
    record::RecorderSettings settings;
    settings.index_seconds = kIndexSeconds;
    auto started = record::Recorder::Start(path, Describe(), *simulation, std::move(settings));
    if (!started) return started.error();
    recorder = std::move(*started);
  }
  const core::Stopwatch watch;
  for (const scene::Input& input : played.inputs) {
    simulation->Step(input);
    if (recorder != nullptr) recorder->Add(input, *simulation);
  }
  const double seconds = watch.Seconds();
  if (simulation->Hash() != played.hash) return WrongAnswer("recording", "the hash is another one");
  if (recorder != nullptr) {
    if (const auto finished = recorder->Finish(*simulation); !finished) return finished.error();
  }
  return seconds;
}

struct SeekTimes {
  double replay = 0, indexed = 0, visited = 0, branch = 0;  // [s]
};

core::Result<SeekTimes> Seek(const Played& played, int threads, const std::filesystem::path& path) {
  SeekTimes times;
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.index = record::IndexPathOf(path);
  settings.visit_seconds = 0;
  const auto open = [&]() -> core::Result<record::Replay> {
    auto recording = record::ReadRecording(path);
    if (!recording) return recording.error();
    return record::Replay::Open(std::move(*recording), settings);
  };
  auto replay = open();
  if (!replay) return replay.error();
  const core::Stopwatch whole;
  while (!replay->IsAtEnd()) replay->Step();
  times.replay = whole.Seconds();
  if (replay->GetSimulation().Hash() != played.hash || replay->GetDivergence())
    return WrongAnswer("replay", "it is not what was recorded");
  // the worst moment lies just before a kept state
  const auto time_seek = [&](double seconds) {
    const auto tick = static_cast<std::uint64_t>(seconds / played.tick_seconds + 0.5) - 1;
    const core::Stopwatch watch;
    const bool is_there = replay->Seek(tick).ok() && replay->Tick() == tick;
    return is_there ? watch.Seconds() : 1e9;
  };
  for (const double moment : {9.0, 6.0, 12.0, 3.0})
    times.indexed = std::max(times.indexed, time_seek(moment));
  settings.visit_seconds = kVisitSeconds;
  replay = open();
  if (!replay) return replay.error();
  if (const auto seen = replay->Seek(replay->GetRecording().LastTick()); !seen) return seen.error();
  for (const double moment : {9.0, 2.25, 11.25, 5.25})
    times.visited = std::max(times.visited, time_seek(moment));
  const core::Stopwatch watch;
  const auto branch = replay->Branch(threads);
  times.branch = watch.Seconds();
  if (!branch) return branch.error();
  if (branch->Hash() != replay->GetSimulation().Hash()) return WrongAnswer("branch", "it stands elsewhere");
  return times;
}

/// Processor time of a tick of the 1 kHz loop, median [s]. \param folder  empty: nothing is recorded
core::Result<double> TimeHapticTick(const Played& played, int threads, const std::filesystem::path& folder) {
  auto simulation = Simulation::Make(played.model, threads);
  if (!simulation) return simulation.error();
  auto driver = device::MakeForceDriver("simulated:held");
  if (!driver) return driver.error();
  auto settings =
      session::MakeHapticSettings(**driver, simulation->GetScene(),
                                  simulation->GetSnapshot().X_world_laparoscope, device::DefaultButtons());
  if (!settings) return settings.error();
  settings->supervisor.clear();
  session::HapticLink link;
  std::optional<session::AttemptKeeping> keeping;
  if (!folder.empty()) keeping = {folder, Describe()};
  session::Runner runner(std::move(*simulation), &link, std::move(keeping));
  auto loop = session::HapticLoop::Start(std::move(*driver), *settings, link);
  if (!loop) return loop.error();
  runner.SetPaused(false);
  device::SystemClock().Sleep(1);
  (*loop)->ClearTimes();
  device::SystemClock().Sleep(kHapticSeconds);
  return (*loop)->CalcCpuPercentile(0.5);
}

}  // namespace

core::Result<BenchmarkResult> RunRecordingBenchmark(const BenchmarkOptions& options) {
  const auto played = PlayExpert(options.threads);
  if (!played) return played.error();
  const core::PartialPath folder(std::filesystem::temp_directory_path() / "trocar_recording_benchmark");
  const auto path = folder.Path() / "a.trocar";
  double without = 1e9, with = 1e9;
  // by turns, so that a computer that becomes slower slows both
  for (int i = 0; i < std::max(1, options.repeats); ++i) {
    const auto plain = Step(*played, options.threads, {});
    if (!plain) return plain.error();
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    std::filesystem::remove(record::IndexPathOf(path), ignored);
    const auto recorded = Step(*played, options.threads, path);
    if (!recorded) return recorded.error();
    without = std::min(without, *plain), with = std::min(with, *recorded);
  }
  double bare_loop = 1e9, recorded_loop = 1e9;
  for (int i = 0; i < 2; ++i) {
    const auto plain = TimeHapticTick(*played, options.threads, {});
    if (!plain) return plain.error();
    const auto recorded = TimeHapticTick(*played, options.threads, folder.Path() / "attempts");
    if (!recorded) return recorded.error();
    bare_loop = std::min(bare_loop, *plain), recorded_loop = std::min(recorded_loop, *recorded);
  }
  const auto times = Seek(*played, options.threads, path);
  if (!times) return times.error();
  const double ticks = static_cast<double>(played->inputs.size());
  std::error_code failure;
  const auto size_of = [&](const std::filesystem::path& file) {
    return static_cast<double>(std::filesystem::file_size(file, failure));
  };
  BenchmarkResult result;
  result.notes.push_back(
      "the expert's first 12 s of the cholecystectomy; recorded with an index as in the window");
  result.cases = {{"tick", 1e3 * without / ticks, "ms"},
                  {"tick/recorded", 1e3 * with / ticks, "ms"},
                  {"haptic tick", 1e6 * bare_loop, "us"},
                  {"haptic tick/recorded", 1e6 * recorded_loop, "us"},
                  {"replay", 1e3 * times->replay / ticks, "ms"},
                  {"seek/index, just before the next state", times->indexed, "s"},
                  {"seek/visited, likewise", times->visited, "s"},
                  {"branch", times->branch, "s"},
                  {"recording", size_of(path), "B"},
                  {"index of 3 s and visits", size_of(record::IndexPathOf(path)), "B"}};
  result.ratios = {{"a tick with recording to one without", with / without},
                   {"a haptic tick with recording to one without", recorded_loop / bare_loop},
                   {"a tick of the replay to one without", times->replay / without}};
  return result;
}

}  // namespace trocar::bench
