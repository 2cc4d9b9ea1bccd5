// SPDX-License-Identifier: Apache-2.0
/// \file environment_benchmark.cpp  What an environment for learning costs: time, pictures, memory, and whether it bears
/// random actions.
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "processor_time.h"
#include "trocar/base/state_hash.h"
#include "trocar/bench/benchmark.h"
#include "trocar/environment/pool.h"
#include "trocar/files/task_file.h"
#include "trocar/math/random.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/scene/task.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::bench {
namespace {

using environment::Environment;
using environment::EnvironmentModel;
using environment::Pool;

constexpr double kSeconds = 2;        // of each measurement
constexpr std::size_t kFurther = 8;   // environments whose memory is measured together
constexpr double kPageBytes = 4096;   // of /proc/self/statm
constexpr int kStepsThatRepeat = 10;  // for which two environments must agree
constexpr int kPictureSide = 84;      // pixels
constexpr int kPoolActions = 300;     // of a thread, or of a process that has a core for itself
constexpr int kManyPerThread = 4;     // environments, in the larger of two pools
constexpr const char* kPoolTask = "peg_transfer";
constexpr const char* kOperation = procedures::kUsualProcedure;

double ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return kPageBytes * resident;
}

/// Memory that has been asked for and not given back; without what the allocator keeps.
double BytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

base::Result<std::shared_ptr<EnvironmentModel>> MakeModel(const std::string& task) {
  return EnvironmentModel::Make({.task = task, .actions = environment::ActionKind::kTip});
}

/// Random actions that move both hands and press nothing.
std::vector<double> DrawActions(const EnvironmentModel& model, std::size_t count, math::Random& random) {
  std::vector<double> actions;
  for (std::size_t i = 0; i < count; ++i) {
    for (const environment::Field& field : model.ActionFields())
      actions.push_back(field.unit == "-" ? -1.0 : random.Uniform(-1, 1));
  }
  return actions;
}

/// Ticks a second of processor time of one environment.
base::Result<double> MeasureAlone(const std::shared_ptr<EnvironmentModel>& model, std::uint64_t seed) {
  auto environment = Environment::Make(model);
  if (!environment) return environment.error();
  if (const auto reset = environment->Reset(seed); !reset) return reset.error();
  math::Random random(seed);
  double steps = 0;
  const WorkStopwatch stopwatch(1);
  while (stopwatch.Seconds() < kSeconds) {
    if (environment->IsOver()) {
      if (const auto reset = environment->Reset(); !reset) return reset.error();
    }
    const auto outcome = environment->Step(DrawActions(*model, 1, random));
    if (!outcome) return outcome.error();
    if (!std::isfinite(outcome->reward)) return WrongAnswer(model->Settings().task, "a reward is not finite");
    ++steps;
  }
  return steps * model->TicksPerAction() / stopwatch.Seconds();
}

/// What a pool, or as many processes, came to.
struct Work {
  double seconds = 0;                 // of processor time, of all threads or processes
  std::vector<std::uint64_t> states;  // fingerprint of each environment's last state
};

std::uint64_t HashState(std::span<const float> state) {
  base::StateHash hash;
  for (const float value : state) hash.Add(static_cast<double>(value));
  return hash.Value();
}

/// So many actions of one environment.
base::Result<Work> TimeActions(const std::shared_ptr<EnvironmentModel>& model, std::uint64_t seed,
                               int count) {
  auto environment = Environment::Make(model);
  if (!environment) return environment.error();
  if (const auto reset = environment->Reset(seed); !reset) return reset.error();
  math::Random random(seed);
  std::vector<float> state(model->StateSize());
  const WorkStopwatch stopwatch(1);
  for (int i = 0; i < count; ++i) {
    const std::vector<double> action = DrawActions(*model, 1, random);
    if (environment->IsOver()) {
      // as a pool does: the action is not used
      if (const auto reset = environment->Reset(); !reset) return reset.error();
    } else if (const auto outcome = environment->Step(action); !outcome) {
      return outcome.error();
    }
    environment->Observe(state);
  }
  return Work{stopwatch.Seconds(), {HashState(state)}};
}

/// How a pool is used: all environments wait for the slowest before each action, or each gets its next as soon as it is done.
enum class PoolUse { kTogether, kEachAtOnce };

/// Environments, which share out the threads of a pool, or the processes among as many cores.
struct Crowd {
  int count = 1, threads = 1;

  int ActionsEach() const { return kPoolActions * threads / count; }
};

/// All threads of a pool together. Environment i does what process i does.
base::Result<Work> MeasurePool(const std::shared_ptr<EnvironmentModel>& model, const Crowd& crowd,
                               PoolUse use) {
  const int count = crowd.count;
  auto made = Pool::Make(model, {.count = count, .threads = crowd.threads});
  if (!made) return made.error();
  Pool& pool = **made;
  std::vector<std::int32_t> ids;
  if (const auto reset = pool.Reset({}, 1); !reset) return reset.error();
  if (const auto begun = pool.Receive(static_cast<std::size_t>(count), ids); !begun) return begun.error();
  std::vector<math::Random> hands;
  for (int i = 0; i < count; ++i) hands.emplace_back(1 + static_cast<std::uint64_t>(i));
  std::vector<int> left(hands.size(), crowd.ActionsEach());
  const WorkStopwatch stopwatch(1);
  while (true) {
    std::vector<std::int32_t> ready;
    std::vector<double> actions;
    for (const std::int32_t id : ids) {
      const auto i = static_cast<std::size_t>(id);
      if (left[i]-- <= 0) continue;
      ready.push_back(id);
      const std::vector<double> drawn = DrawActions(*model, 1, hands[i]);
      actions.insert(actions.end(), drawn.begin(), drawn.end());
    }
    if (!ready.empty()) {
      if (const auto sent = pool.Send(actions, ready); !sent) return sent.error();
    }
    if (pool.AtWork() == 0) break;
    const std::size_t wanted = use == PoolUse::kTogether ? pool.AtWork() : 1;
    if (const auto got = pool.Receive(wanted, ids); !got) return got.error();
  }
  Work work{stopwatch.Seconds(), {}};
  const std::size_t size = model->StateSize();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    work.states.push_back(HashState(std::span(pool.Rows().state).subspan(i * size, size)));
  return work;
}

/// What a process tells the one that began it.
struct Told {
  double seconds = -1;
  std::uint64_t state = 0;
};

/// As many processes at a time, each with an environment of its own.
base::Result<Work> MeasureProcesses(const std::string& task, const Crowd& crowd) {
  std::vector<std::pair<pid_t, int>> children;
  for (int i = 0; i < crowd.count; ++i) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return WrongAnswer("processes", "no pipe can be made");
    const pid_t child = fork();
    if (child == 0) {
      const auto model = MakeModel(task);
      Told told;
      if (model.ok()) {
        const auto measured = TimeActions(*model, 1 + static_cast<std::uint64_t>(i), crowd.ActionsEach());
        if (measured.ok()) told = {measured->seconds, measured->states.front()};
      }
      const bool is_told = write(ends[1], &told, sizeof told) == sizeof told;
      _exit(is_told ? 0 : 1);
    }
    close(ends[1]);
    children.emplace_back(child, ends[0]);
  }
  Work work;
  bool is_whole = true;
  for (const auto& [child, end] : children) {
    Told told;
    is_whole = child > 0 && read(end, &told, sizeof told) == sizeof told && told.seconds > 0 && is_whole;
    work.seconds += told.seconds;
    work.states.push_back(told.state);
    close(end);
    if (child > 0) waitpid(child, nullptr, 0);
  }
  if (!is_whole) return WrongAnswer("processes", "one of them failed");
  return work;
}

/// A pool, used in both ways, beside as many processes, by turns, in which each is once the first: the quickest of each counts.
/// All must come to the same states.
base::Status ComparePool(const Crowd& crowd, int repeats, BenchmarkResult& result) {
  constexpr std::array kUses = {PoolUse::kTogether, PoolUse::kEachAtOnce};
  std::array<double, kUses.size()> pools;
  pools.fill(std::numeric_limits<double>::infinity());
  double alone = std::numeric_limits<double>::infinity();
  std::vector<std::uint64_t> states;
  const auto add = [&](const base::Result<Work>& work, double& quickest) -> base::Status {
    if (!work) return work.error();
    if (states.empty()) states = work->states;
    if (work->states != states) return WrongAnswer("pool", "it comes to other states than as many processes");
    quickest = std::min(quickest, work->seconds);
    return {};
  };
  for (int turn = 0; turn < std::max(1, repeats); ++turn) {
    for (std::size_t k = 0; k <= kUses.size(); ++k) {
      const std::size_t use = (k + static_cast<std::size_t>(turn)) % (kUses.size() + 1);
      if (use == kUses.size()) {
        // while this process has no model and threads of its own
        if (const auto added = add(MeasureProcesses(kPoolTask, crowd), alone); !added) return added;
        continue;
      }
      const auto model = MakeModel(kPoolTask);
      if (!model) return model.error();
      if (const auto added = add(MeasurePool(*model, crowd, kUses[use]), pools[use]); !added) return added;
    }
  }
  const auto model = MakeModel(kPoolTask);
  if (!model) return model.error();
  const double ticks = static_cast<double>(crowd.count) * crowd.ActionsEach() * (*model)->TicksPerAction();
  const std::string of = "_of_" + std::to_string(crowd.count), pool = "pool" + of,
                    at_once = "pool_at_once" + of, processes = "processes" + of;
  result.cases.push_back({pool + "/rate", ticks / pools[0], "ticks/s"});
  result.cases.push_back({at_once + "/rate", ticks / pools[1], "ticks/s"});
  result.cases.push_back({processes + "/rate", ticks / alone, "ticks/s"});
  result.ratios.push_back({pool + "/" + processes, alone / pools[0]});
  result.ratios.push_back({at_once + "/" + processes, alone / pools[1]});
  return {};
}

/// Two environments of the same seed and actions must agree, or their times mean nothing.
base::Status CheckRepeats(const std::shared_ptr<EnvironmentModel>& model) {
  std::array<std::uint64_t, 2> hashes{};
  for (std::uint64_t& hash : hashes) {
    auto environment = Environment::Make(model);
    if (!environment) return environment.error();
    if (const auto reset = environment->Reset(1); !reset) return reset.error();
    math::Random random(1);
    for (int i = 0; i < kStepsThatRepeat && !environment->IsOver(); ++i) {
      if (const auto outcome = environment->Step(DrawActions(*model, 1, random)); !outcome)
        return outcome.error();
    }
    hash = environment->GetSimulation().Hash();
  }
  if (hashes[0] != hashes[1]) return WrongAnswer(model->Settings().task, "the same actions give other bits");
  return {};
}

/// [B] of each further environment of one model.
base::Result<double> MeasureMemory(const std::shared_ptr<EnvironmentModel>& model) {
  std::vector<Environment> environments;
  environments.reserve(kFurther + 1);
  double before = 0;
  for (std::size_t i = 0; i <= kFurther; ++i) {
    auto made = Environment::Make(model);
    if (!made) return made.error();
    environments.push_back(std::move(*made));
    if (const auto reset = environments.back().Reset(1); !reset) return reset.error();
    math::Random random(1);
    for (int step = 0; step < 2; ++step) {
      if (const auto outcome = environments.back().Step(DrawActions(*model, 1, random)); !outcome)
        return outcome.error();
    }
    if (i == 0) before = ResidentBytes();
  }
  return (ResidentBytes() - before) / static_cast<double>(kFurther);
}

/// Actions a second of processor time, the drawing threads' too, whose observation is a picture, drawn as the package for Python does.
base::Result<double> MeasurePictures(const std::shared_ptr<EnvironmentModel>& model) {
  auto context = render::OffscreenContext::Make();
  if (!context) return context.error();
  auto target = render::OffscreenTarget::Make(kPictureSide, kPictureSide);
  if (!target) return target.error();
  auto environment = Environment::Make(model);
  if (!environment) return environment.error();
  if (const auto reset = environment->Reset(1); !reset) return reset.error();
  const simulation::Simulation& simulation = environment->GetSimulation();
  auto view = view::LaparoscopeView::Make(simulation.GetScene(), simulation.Surfaces(),
                                          simulation.GetSnapshot(), simulation.Strands());
  if (!view) return view.error();
  view->SetOptions({.has_force_arrows = false, .has_automatic_exposure = false});
  render::Image image;
  const auto draw = [&] {
    view->Update(simulation.GetSnapshot());
    target->Bind();
    view->Draw(kPictureSide, kPictureSide);
    target->Read(image);
  };
  // the first, because random motions may turn the laparoscope to where nothing is
  draw();
  if (std::all_of(image.pixels.begin(), image.pixels.end(),
                  [&](std::uint8_t byte) { return byte == image.pixels.front(); }))
    return WrongAnswer(model->Settings().task, "a picture shows nothing");
  math::Random random(1);
  double steps = 0;
  const WorkStopwatch stopwatch(1);
  while (stopwatch.Seconds() < kSeconds && !environment->IsOver()) {
    if (const auto outcome = environment->Step(DrawActions(*model, 1, random)); !outcome)
      return outcome.error();
    draw();
    ++steps;
  }
  return steps / stopwatch.Seconds();
}

/// Random actions, pedals too, one episode after the other.
base::Status TakeRandomActions(Environment& environment, const EnvironmentModel& model, int steps,
                               std::uint64_t seed) {
  if (const auto reset = environment.Reset(seed); !reset) return reset.error();
  math::Random random(seed);
  std::vector<float> state(model.StateSize());
  std::vector<double> action(model.ActionSize());
  for (int step = 0; step < steps; ++step) {
    if (environment.IsOver()) {
      if (const auto reset = environment.Reset(); !reset) return reset.error();
    }
    for (double& value : action) value = random.Uniform(-1, 1);
    const auto outcome = environment.Step(action);
    if (!outcome) return outcome.error();
    environment.Observe(state);
    const bool is_finite = std::isfinite(outcome->reward) &&
                           std::all_of(state.begin(), state.end(), [](float v) { return std::isfinite(v); });
    if (!is_finite)
      return WrongAnswer(model.Settings().task,
                         "not finite after " + std::to_string(step + 1) + " random actions");
  }
  return {};
}

/// The same actions twice: what the first turn needed is kept for the worst that came, so the second turn needs no more,
/// unless something is lost; and it ends in the same state.
/// \return  [B] by which the memory in use grew in the second turn
base::Result<double> Soak(const std::shared_ptr<EnvironmentModel>& model, int steps, std::uint64_t seed) {
  auto environment = Environment::Make(model);
  if (!environment) return environment.error();
  if (const auto first = TakeRandomActions(*environment, *model, steps, seed); !first) return first.error();
  const std::uint64_t hash = environment->GetSimulation().Hash();
  const double before = BytesInUse();
  if (const auto second = TakeRandomActions(*environment, *model, steps, seed); !second)
    return second.error();
  const double growth = BytesInUse() - before;
  if (environment->GetSimulation().Hash() != hash)
    return WrongAnswer(model->Settings().task, "the same actions led elsewhere the second time");
  return growth;
}

/// The delivered tasks and the operation.
base::Result<std::vector<std::string>> ListEnvironments() {
  const auto tasks = files::ListTasks();
  if (!tasks) return tasks.error();
  std::vector<std::string> keys;
  for (const files::TaskEntry& task : *tasks) keys.push_back(task.key);
  keys.emplace_back(kOperation);
  return keys;
}

}  // namespace

base::Result<BenchmarkResult> RunEnvironmentBenchmark(const BenchmarkOptions& options) {
  const int threads = std::max(1, options.threads);
  BenchmarkResult result;
  result.notes.push_back(
      "seconds are of processor time; random motions of both tips, 10 actions a second; pools (all "
      "together, and each at once) on " +
      std::to_string(threads) +
      " threads (--threads), and as many processes as environments, the quickest of " +
      std::to_string(std::max(1, options.repeats)) + " turns (--repeats)");
  for (const int each : {1, kManyPerThread}) {
    const auto compared = ComparePool({each * threads, threads}, options.repeats, result);
    if (!compared) return compared.error();
  }
  const auto tasks = ListEnvironments();
  if (!tasks) return tasks.error();
  for (const std::string& task : *tasks) {
    const auto model = MakeModel(task);
    if (!model) return model.error();
    if (const auto repeats = CheckRepeats(*model); !repeats) return repeats.error();
    const auto rate = MeasureAlone(*model, 1);
    if (!rate) return rate.error();
    result.cases.push_back({task + "/rate", *rate, "ticks/s"});
    const auto memory = MeasureMemory(*model);
    if (!memory) return memory.error();
    result.cases.push_back({task + "/memory_each", 1e-6 * *memory, "MB"});
    const auto pictures = MeasurePictures(*model);
    if (!pictures) return pictures.error();
    result.cases.push_back({task + "/pictures", *pictures, "actions/s"});
  }
  return result;
}

base::Result<BenchmarkResult> RunSoakBenchmark(const BenchmarkOptions& options) {
  const auto tasks = ListEnvironments();
  if (!tasks) return tasks.error();
  const int each = std::max(3, options.steps / (2 * static_cast<int>(tasks->size())));
  BenchmarkResult result;
  double most = 0;
  for (const std::string& task : *tasks) {
    const auto model = MakeModel(task);
    if (!model) return model.error();
    const auto bytes = Soak(*model, each, options.seed);
    if (!bytes) return bytes.error();
    result.cases.push_back({task + "/growth", 1e-6 * *bytes, "MB"});
    most = std::max(most, *bytes);
  }
  result.cases.push_back({"actions", 2.0 * each * static_cast<double>(tasks->size()), "1"});
  result.cases.push_back({"most_growth", 1e-6 * most, "MB"});
  return result;
}

}  // namespace trocar::bench
