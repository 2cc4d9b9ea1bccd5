// SPDX-License-Identifier: Apache-2.0
// What recording costs a tick, how quickly a replay runs, seeks and branches.
#include <algorithm>
#include <ctime>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "processor_time.h"
#include "trocar/agent/surgeon.h"
#include "trocar/bench/benchmark.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/device/ports.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/threads.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/record/recorder.h"
#include "trocar/record/replay.h"
#include "trocar/record/trace.h"
#include "trocar/scene/scene.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/session/runner.h"
#include "trocar/session/session_input.h"

namespace trocar::bench {
namespace {

using simulation::Simulation;

constexpr double kSeconds = 12;         // of the operation that is recorded
constexpr double kHapticSeconds = 4;    // that the 1 kHz loop is watched
constexpr double kVisitSeconds = 0.75;  // as the replay window keeps it

struct Played {
  std::shared_ptr<const simulation::SimulationModel> model;
  std::vector<scene::Input> inputs;
  std::uint64_t hash = 0;
  double tick_seconds = 0;
};

base::Result<Played> PlayExpert(int threads) {
  auto scene = files::FindOperation(procedures::kUsualProcedure, {}, 1);
  if (!scene) return scene.error();
  const auto shared = std::make_shared<const scene::Scene>(std::move(**scene));
  Played played;
  auto model = simulation::MakeSimulationModel(shared, host::UseThreads(threads));
  if (!model) return model.error();
  played.model = *model;
  played.tick_seconds = shared->tick_seconds;
  auto simulation = Simulation::Make(played.model, {.threads = host::UseThreads(threads)});
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
  description.name = procedures::kUsualProcedure;
  description.seed = 1;
  description.player = "a benchmark";
  return description;
}

double ThreadSeconds() {
  std::timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Processor time of all ticks [s]: other programs on the machine do not lengthen it.
struct Cost {
  double thread = 1e9;   ///< of the thread that steps: what a tick takes longer
  double process = 1e9;  ///< of all threads, until everything is written

  void Lower(const Cost& other) {
    thread = std::min(thread, other.thread);
    process = std::min(process, other.process);
  }
};

enum class Keeps { kNothing, kRecording, kTrace };

/// \param path  of the recording, replaced
base::Result<Cost> Step(const Played& played, int threads, Keeps keeps, const std::filesystem::path& path) {
  auto simulation = Simulation::Make(played.model, {.threads = host::UseThreads(threads)});
  if (!simulation) return simulation.error();
  std::unique_ptr<record::Recorder> recorder;
  std::optional<record::TraceBuilder> trace;
  if (keeps == Keeps::kRecording) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    std::filesystem::remove(record::IndexPathOf(path), ignored);
    record::RecorderSettings settings;
    settings.index_seconds = record::kIndexSeconds;
    auto started = record::Recorder::Start(path, Describe(), *simulation, std::move(settings));
    if (!started) return started.error();
    recorder = std::move(*started);
  } else if (keeps == Keeps::kTrace) {
    trace.emplace(*simulation);
  }
  const WorkStopwatch process(1);
  const double start = ThreadSeconds();
  for (const scene::Input& input : played.inputs) {
    simulation->Step(input);
    if (recorder != nullptr) recorder->Add(input, *simulation);
    if (trace) trace->Add(simulation->GetSnapshot(), input.controls);
  }
  Cost cost;
  cost.thread = ThreadSeconds() - start;
  if (recorder != nullptr) {
    if (const auto finished = recorder->Finish(*simulation); !finished) return finished.error();
  }
  cost.process = process.Seconds();
  if (simulation->Hash() != played.hash) return WrongAnswer("recording", "the hash is another one");
  return cost;
}

/// By the clock and by the processor time of all threads [s].
struct Times {
  double clock = 0, processor = 0;
};

class TwoStopwatches {
 public:
  Times Get() const { return {clock_.Seconds(), processor_.Seconds()}; }

 private:
  host::Stopwatch clock_;
  WorkStopwatch processor_{1};
};

/// Processor time of all ticks of a replay, with its comparison of hashes [s].
base::Result<double> TimeReplay(const Played& played, int threads, const std::filesystem::path& path) {
  auto recording = record::ReadRecording(path);
  if (!recording) return recording.error();
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.visit_seconds = 0;
  auto replay = record::Replay::Open(std::move(*recording), settings);
  if (!replay) return replay.error();
  const WorkStopwatch watch(1);
  while (!replay->IsAtEnd()) replay->Step();
  const double seconds = watch.Seconds();
  if (replay->GetSimulation().Hash() != played.hash || replay->GetDivergence())
    return WrongAnswer("replay", "it is not what was recorded");
  return seconds;
}

struct SeekTimes {
  Times indexed, visited, branch;
};

base::Result<SeekTimes> Seek(const Played& played, int threads, const std::filesystem::path& path) {
  SeekTimes times;
  record::ReplaySettings settings;
  settings.threads = threads;
  settings.index = record::IndexPathOf(path);
  settings.visit_seconds = 0;
  const auto open = [&]() -> base::Result<record::Replay> {
    auto recording = record::ReadRecording(path);
    if (!recording) return recording.error();
    return record::Replay::Open(std::move(*recording), settings);
  };
  auto replay = open();
  if (!replay) return replay.error();
  // the worst moment lies just before a kept state
  const auto seek = [&](double seconds, Times& longest) {
    const auto tick = static_cast<std::uint64_t>(seconds / played.tick_seconds + 0.5) - 1;
    const TwoStopwatches watch;
    const bool is_there = replay->Seek(tick).ok() && replay->Tick() == tick;
    const Times taken = watch.Get();
    longest.clock = std::max(longest.clock, taken.clock);
    longest.processor = std::max(longest.processor, taken.processor);
    return is_there;
  };
  for (const double moment : {10.0, 6.0, 12.0, 2.0}) {
    if (!seek(moment, times.indexed)) return WrongAnswer("seek", "it ends at another tick");
  }
  settings.visit_seconds = kVisitSeconds;
  replay = open();
  if (!replay) return replay.error();
  while (!replay->IsAtEnd()) replay->Step();  // watches all of it
  for (const double moment : {9.0, 2.25, 11.25, 5.25}) {
    if (!seek(moment, times.visited)) return WrongAnswer("seek", "it ends at another tick");
  }
  const TwoStopwatches watch;
  const auto branch = replay->Branch(threads);
  times.branch = watch.Get();
  if (!branch) return branch.error();
  if (branch->Hash() != replay->GetSimulation().Hash()) return WrongAnswer("branch", "it stands elsewhere");
  return times;
}

/// Processor time of a tick of the 1 kHz loop, median [s]. \param folder  empty: nothing is recorded
base::Result<double> TimeHapticTick(const Played& played, int threads, const std::filesystem::path& folder) {
  auto simulation = Simulation::Make(played.model, {.threads = host::UseThreads(threads)});
  if (!simulation) return simulation.error();
  auto driver = device::MakeForceDriver("simulated:held");
  if (!driver) return driver.error();
  auto settings =
      session::MakeHapticSettings(**driver, simulation->GetScene(),
                                  simulation->GetSnapshot().X_world_laparoscope, device::DefaultButtons());
  if (!settings) return settings.error();
  settings->supervisor.clear();
  session::HapticLink link;
  session::SessionInput input(simulation->GetScene());
  input.UseHaptics(link);
  session::RunnerSettings running;
  running.haptics = &link;
  if (!folder.empty()) running.keeping = {folder, Describe()};
  session::Runner runner(std::move(*simulation), input, std::move(running));
  auto loop = session::HapticLoop::Start(std::move(*driver), *settings, link);
  if (!loop) return loop.error();
  runner.SetPaused(false);
  device::SystemClock().Sleep(1);
  (*loop)->ClearTimes();
  device::SystemClock().Sleep(kHapticSeconds);
  return (*loop)->CalcCpuPercentile(0.5);
}

}  // namespace

base::Result<BenchmarkResult> RunRecordingBenchmark(const BenchmarkOptions& options) {
  const auto played = PlayExpert(options.threads);
  if (!played) return played.error();
  const host::PartialPath folder(std::filesystem::temp_directory_path() / "trocar_recording_benchmark");
  const auto path = folder.Path() / "a.trocar";
  Cost bare, recorded, traced;
  double replayed = 1e9;
  // by turns, so that a computer that becomes slower slows all
  for (int i = 0; i < std::max(1, options.repeats); ++i) {
    for (auto [keeps, cost] : {std::pair(Keeps::kNothing, &bare), std::pair(Keeps::kRecording, &recorded),
                               std::pair(Keeps::kTrace, &traced)}) {
      const auto taken = Step(*played, options.threads, keeps, path);
      if (!taken) return taken.error();
      cost->Lower(*taken);
    }
    const auto taken = TimeReplay(*played, options.threads, path);
    if (!taken) return taken.error();
    replayed = std::min(replayed, *taken);
  }
  double bare_loop = 1e9, recorded_loop = 1e9;
  for (int i = 0; i < 2; ++i) {
    const auto plain = TimeHapticTick(*played, options.threads, {});
    if (!plain) return plain.error();
    const auto with_recording = TimeHapticTick(*played, options.threads, folder.Path() / "attempts");
    if (!with_recording) return with_recording.error();
    bare_loop = std::min(bare_loop, *plain), recorded_loop = std::min(recorded_loop, *with_recording);
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
      "the expert's first 12 s of the cholecystectomy; recorded with an index as in the window; ticks in "
      "processor time");
  result.cases = {{"tick", 1e3 * bare.thread / ticks, "ms"},
                  {"tick/recorded", 1e3 * recorded.thread / ticks, "ms"},
                  {"tick/recorded, with the writing thread", 1e3 * recorded.process / ticks, "ms"},
                  {"tick/with what metrics are made of", 1e3 * traced.thread / ticks, "ms"},
                  {"haptic tick", 1e6 * bare_loop, "us"},
                  {"haptic tick/recorded", 1e6 * recorded_loop, "us"},
                  {"replay", 1e3 * replayed / ticks, "ms"},
                  {"seek/index, just before the next state", times->indexed.clock, "s"},
                  {"seek/index, processor time", times->indexed.processor, "s"},
                  {"seek/visited, likewise", times->visited.clock, "s"},
                  {"seek/visited, processor time", times->visited.processor, "s"},
                  {"branch", times->branch.clock, "s"},
                  {"branch/processor time", times->branch.processor, "s"},
                  {"recording", size_of(path), "B"},
                  {"index and visits", size_of(record::IndexPathOf(path)), "B"}};
  result.ratios = {{"a tick with recording to one without", recorded.thread / bare.thread},
                   {"the same, with the writing thread", recorded.process / bare.process},
                   {"a tick with what metrics are made of to one without", traced.thread / bare.thread},
                   {"a haptic tick with recording to one without", recorded_loop / bare_loop},
                   {"a tick of the replay to one without", replayed / bare.process}};
  return result;
}

}  // namespace trocar::bench
