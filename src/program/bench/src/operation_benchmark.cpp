// SPDX-License-Identifier: Apache-2.0
/// \file operation_benchmark.cpp  The tick of an operation in fixed parts of it, how far each leaves the equilibrium, and the
/// same of another build by turns.
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "measured_cases.h"
#include "processor_time.h"
#include "trocar/agent/surgeon.h"
#include "trocar/assessment/play_state.h"
#include "trocar/base/state_hash.h"
#include "trocar/base/statistics.h"
#include "trocar/bench/benchmark.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/progress_bar.h"
#include "trocar/host/text_table.h"
#include "trocar/host/threads.h"
#include "trocar/host/user_folder.h"
#include "trocar/simulation/simulation.h"

namespace trocar::bench {
namespace {

namespace fs = std::filesystem;
using simulation::Simulation;
using simulation::Snapshot;

constexpr double kPartSeconds = 6;         // of each part [s]
constexpr double kMostSeconds = 900;       // until a part begins [s]
constexpr std::uint64_t kJudgedEach = 60;  // ticks
constexpr std::uint64_t kSeed = 1;

/// A stretch of an operation on the built-in patient: what the surgeon does from the first tick that begins it.
struct Part {
  const char* name;
  const char* surgeon;
  bool (*begins)(const Simulation& simulation);
};

bool IsAnyToolOf(const Simulation& simulation, instrument::ToolKind kind) {
  const auto& setups = simulation.GetScene().instruments;
  for (std::size_t hand = 0; hand < setups.size(); ++hand) {
    const auto& tray = setups[hand].tray;
    const std::size_t at = simulation.GetSnapshot().operation.tools[hand];
    if (at < tray.size() && tray[at].kind == kind) return true;
  }
  return false;
}

constexpr Part kParts[] = {
    {"traction", "expert", [](const Simulation&) { return true; }},
    {"fat", "expert",
     [](const Simulation& simulation) {
       const auto& intact = simulation.GetSnapshot().operation.strand_is_intact;
       return std::ranges::find(intact, 0) != intact.end();
     }},
    {"clips", "expert",
     [](const Simulation& simulation) {
       return IsAnyToolOf(simulation, instrument::ToolKind::kClipApplier);
     }},
    {"bed", "expert",
     [](const Simulation& simulation) {
       const auto& operation = simulation.GetSnapshot().operation;
       const double entering = scene::MeasureOf(scene::ProcedureOf(simulation.GetScene()),
                                                operation.procedure, "structures_entering");
       return operation.clip_count > 0 && entering == 0.0 &&
              IsAnyToolOf(simulation, instrument::ToolKind::kHook);
     }},
    {"bleeding", "bleeds",
     [](const Simulation& simulation) { return simulation.GetSnapshot().operation.flow.leak_count > 0; }},
};
constexpr std::size_t kPartCount = std::size(kParts);

struct Player {
  Simulation simulation;
  std::unique_ptr<agent::Surgeon> surgeon;
  std::string who;
};

class Operation {
 public:
  static base::Result<Operation> Make(int threads) {
    auto scene = files::FindOperation("cholecystectomy", {}, kSeed);
    if (!scene) return scene.error();
    Operation made;
    made.threads_ = threads;
    made.scene_ = std::make_shared<const scene::Scene>(std::move(**scene));
    auto model = simulation::MakeSimulationModel(made.scene_, host::UseThreads(threads));
    if (!model) return model.error();
    made.model_ = std::move(*model);
    return made;
  }

  /// Simulation and surgeon where the part begins. What that costs minutes to reach is kept in the user's cache folder.
  base::Result<Player> Begin(const Part& part, host::ProgressBar& bar) const {
    auto simulation = Simulation::Make(model_, {.threads = host::UseThreads(threads_)});
    if (!simulation) return simulation.error();
    auto surgeon = agent::MakeSurgeon(part.surgeon, scene_, kSeed);
    if (!surgeon) return surgeon.error();
    Player player{std::move(*simulation), std::move(*surgeon), std::string(part.surgeon) + ", seed 1"};
    const fs::path state =
        host::FindCacheFolder() / "bench" /
        (base::HashText(player.simulation.ModelFingerprint()) + "-" + part.name + ".state");
    if (assessment::RestorePlay(state, player.who, player.simulation, *player.surgeon).ok()) return player;
    player.simulation.Reset();
    auto again = agent::MakeSurgeon(part.surgeon, scene_, kSeed);
    if (!again) return again.error();
    player.surgeon = std::move(*again);
    while (!part.begins(player.simulation)) {
      const Snapshot& now = player.simulation.GetSnapshot();
      if (now.time > kMostSeconds || player.surgeon->HasFinished()) {
        return WrongAnswer(std::string("operation/") + part.name,
                           "the scripted surgeon does not come to this part");
      }
      player.simulation.Step(player.surgeon->Act(now));
      if (now.tick % 120 == 0)
        bar.SetLabel(std::string(part.name) + ": played up to " + host::FormatNumber(now.time, 4) + " s");
    }
    if (const auto saved = assessment::SavePlay(state, player.who, player.simulation, *player.surgeon);
        !saved)
      return saved.error();
    return player;
  }

 private:
  int threads_ = 1;
  std::shared_ptr<const scene::Scene> scene_;
  std::shared_ptr<const simulation::SimulationModel> model_;
};

/// The ticks of one part: the same work in every run, so the quickest of each counts.
struct Times {
  std::vector<double> tick_ms;
  std::vector<bool> has_cut;
  double planning_ms = std::numeric_limits<double>::infinity();  // of all ticks
  std::optional<std::uint64_t> hash;

  double Sum() const {
    double sum = 0;
    for (const double ms : tick_ms) sum += ms;
    return sum;
  }
};

base::Status Run(const Part& part, Player& player, int threads, Times& times) {
  const auto ticks = static_cast<std::size_t>(kPartSeconds / player.simulation.GetScene().tick_seconds);
  times.tick_ms.resize(ticks, std::numeric_limits<double>::infinity());
  times.has_cut.resize(ticks);
  double planning_ms = 0;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const std::uint32_t version = player.simulation.GetSnapshot().operation.topology.version;
    const WorkStopwatch planning(threads);
    const scene::Input input = player.surgeon->Act(player.simulation.GetSnapshot());
    planning_ms += 1e3 * planning.Seconds();
    const WorkStopwatch step(threads);
    player.simulation.Step(input);
    times.tick_ms[tick] = std::min(times.tick_ms[tick], 1e3 * step.Seconds());
    times.has_cut[tick] = player.simulation.GetSnapshot().operation.topology.version != version;
  }
  times.planning_ms = std::min(times.planning_ms, planning_ms);
  const std::uint64_t hash = player.simulation.Hash();
  if (hash != times.hash.value_or(hash))
    return WrongAnswer(std::string("operation/") + part.name, "two runs end in different states");
  times.hash = hash;
  return {};
}

/// True errors of every kJudgedEach-th tick.
void Judge(Player& player, std::vector<double>& errors, int& unsettled) {
  const auto ticks = static_cast<std::uint64_t>(kPartSeconds / player.simulation.GetScene().tick_seconds);
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    player.simulation.Step(player.surgeon->Act(player.simulation.GetSnapshot()));
    if (tick % kJudgedEach != 0) continue;
    const double error = player.simulation.CalcEquilibriumError();
    std::isfinite(error) ? errors.push_back(error) : void(++unsettled);
  }
}

void AddTimes(const std::string& name, const std::vector<const Times*>& parts, BenchmarkResult& result) {
  std::vector<double> ticks, cuts;
  for (const Times* part : parts) {
    ticks.insert(ticks.end(), part->tick_ms.begin(), part->tick_ms.end());
    for (std::size_t tick = 0; tick < part->tick_ms.size(); ++tick) {
      if (part->has_cut[tick]) cuts.push_back(part->tick_ms[tick]);
    }
  }
  double sum = 0;
  for (const double ms : ticks) sum += ms;
  result.cases.push_back({name + "/ticks_per_s", 1e3 * static_cast<double>(ticks.size()) / sum, "1/s"});
  result.cases.push_back({name + "/tick_p50", base::CalcPercentile(ticks, 0.5), "ms"});
  result.cases.push_back({name + "/tick_p99", base::CalcPercentile(ticks, 0.99), "ms"});
  if (!cuts.empty()) result.cases.push_back({name + "/tick_cut", base::CalcPercentile(cuts, 1.0), "ms"});
}

/// What another build says of itself, by case.
base::Result<std::map<std::string, double>> AskOther(const std::string& program, int threads) {
  // quoted for the shell: what stands in quotes has none itself
  std::string quoted = "'";
  for (const char c : program) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  const std::string command = quoted + "' bench operation --json --repeats 1 --no-errors --threads " +
                              std::to_string(threads) + " 2>/dev/null";
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> block;
  while (pipe != nullptr) {
    const std::size_t read = std::fread(block.data(), 1, block.size(), pipe);
    if (read == 0) break;
    text.append(block.data(), read);
  }
  const int status = pipe != nullptr ? ::pclose(pipe) : -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
    auto values = ReadMeasuredCases(text, program);
    if (values.ok() && values->contains("operation/ticks_per_s")) return values;
  }
  return base::Error{base::ErrorCode::kUsage, program +
                                                  " does not answer \"bench operation --json\"; give "
                                                  "--beside a trocar program that has this benchmark"};
}

}  // namespace

base::Result<BenchmarkResult> RunOperationBenchmark(const BenchmarkOptions& options) {
  const auto operation = Operation::Make(options.threads);
  if (!operation) return operation.error();
  std::array<Times, kPartCount> times;
  std::map<std::string, double> others;
  std::vector<double> errors;
  int unsettled = 0;
  host::ProgressBar bar("the operation, part by part",
                        (options.repeats + 1) * static_cast<double>(kPartCount));
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    // the other first: what is no such program is told at once
    const auto other = options.beside.empty()
                           ? base::Result<std::map<std::string, double>>(std::map<std::string, double>())
                           : AskOther(options.beside, options.threads);
    if (!other) return other.error();
    for (const auto& [name, value] : *other) {
      const bool is_rate = name.ends_with("ticks_per_s") || name.ends_with("times_real_time");
      const auto [entry, is_new] = others.try_emplace(name, value);
      if (!is_new) entry->second = is_rate ? std::max(entry->second, value) : std::min(entry->second, value);
    }
    for (std::size_t at = 0; at < kPartCount; ++at) {
      bar.SetLabel(kParts[at].name);
      bar.Show(repeat * static_cast<double>(kPartCount) + static_cast<double>(at));
      auto player = operation->Begin(kParts[at], bar);
      if (!player) return player.error();
      if (const auto run = Run(kParts[at], *player, options.threads, times[at]); !run) return run.error();
    }
  }
  for (std::size_t at = 0; options.judges_errors && at < kPartCount; ++at) {
    bar.SetLabel("how far from equilibrium");
    bar.Show(options.repeats * static_cast<double>(kPartCount) + static_cast<double>(at));
    auto player = operation->Begin(kParts[at], bar);
    if (!player) return player.error();
    Judge(*player, errors, unsettled);
  }
  bar.Finish();

  BenchmarkResult result;
  result.notes.push_back(
      "the cholecystectomy on the built-in patient: " + std::to_string(kPartCount) + " parts of " +
      host::FormatNumber(kPartSeconds, 2) +
      " s each, played by scripted surgeons; processor time with "
      "one thread, the clock's with more; the quickest of the repeats counts tick by tick");
  std::vector<const Times*> all;
  double seconds = 0, simulated = 0;
  for (const Times& part : times) {
    all.push_back(&part);
    seconds += 1e-3 * (part.Sum() + part.planning_ms);
    simulated += kPartSeconds;
  }
  AddTimes("operation", all, result);
  result.cases.push_back({"operation/times_real_time", simulated / seconds, "1"});
  for (std::size_t at = 0; at < kPartCount; ++at)
    AddTimes(std::string("operation/") + kParts[at].name, {&times[at]}, result);
  if (options.judges_errors) {
    result.cases.push_back({"operation/judged_ticks", static_cast<double>(errors.size()), "1"});
    result.cases.push_back({"operation/unsettled_ticks", static_cast<double>(unsettled), "1"});
    result.cases.push_back({"operation/true_error_median", base::CalcPercentile(errors, 0.5), "1"});
    result.cases.push_back({"operation/true_error_p90", base::CalcPercentile(errors, 0.9), "1"});
    result.cases.push_back({"operation/true_error_max", base::CalcPercentile(errors, 1.0), "1"});
  }
  for (const BenchmarkCase& entry : result.cases) {
    const auto other = others.find(entry.name);
    if (other != others.end() && other->second > 0.0)
      result.ratios.push_back({entry.name, entry.value / other->second});
  }
  return result;
}

}  // namespace trocar::bench
