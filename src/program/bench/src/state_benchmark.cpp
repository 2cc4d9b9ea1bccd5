// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "trocar/bench/benchmark.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/threads.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"

namespace trocar::bench {
namespace {

constexpr int kTicksBefore = 120;    // what is saved is no state at rest
constexpr std::size_t kCopies = 8;   // whose memory is measured together
constexpr double kPageBytes = 4096;  // of /proc/self/statm

double ResidentBytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return kPageBytes * resident;
}

void Play(simulation::Simulation& simulation, int ticks) {
  for (int tick = 0; tick < ticks; ++tick)
    simulation.Step(scene::CalcScriptInput(simulation.GetScene(), simulation.GetSnapshot().time));
}

}  // namespace

base::Result<BenchmarkResult> RunStateBenchmark(const BenchmarkOptions& options) {
  const auto folder = host::FindDataFolder();
  if (!folder) return folder.error();
  auto read = files::ReadScene(*folder / "scenes/cholecystectomy.json");
  if (!read) return read.error();
  const auto model = simulation::MakeSimulationModel(std::make_shared<const scene::Scene>(std::move(*read)),
                                                     host::UseThreads(options.threads));
  if (!model) return model.error();
  auto made = simulation::Simulation::Make(*model, {.threads = host::UseThreads(options.threads)});
  if (!made) return made.error();

  const double before = ResidentBytes();
  std::vector<simulation::Simulation> copies;
  for (std::size_t i = 0; i < kCopies; ++i) {
    auto copy = simulation::Simulation::Make(*model, {.threads = host::UseThreads(options.threads)});
    if (!copy) return copy.error();
    copies.push_back(std::move(*copy));
  }
  const double each = (ResidentBytes() - before) / static_cast<double>(kCopies);

  Play(*made, kTicksBefore);
  std::vector<std::byte> bytes;
  made->Save(bytes);
  const std::uint64_t hash = made->Hash();
  simulation::Simulation& other = copies.front();
  if (!other.Restore(bytes).ok() || other.Hash() != hash)
    return WrongAnswer("restore", "the restored state is another one");
  Play(*made, kTicksBefore), Play(other, kTicksBefore);
  if (other.Hash() != made->Hash())
    return WrongAnswer("restore", "the restored simulation goes on to other bits");

  const auto nothing = [] {};
  const double save = TimeShortest(options.repeats, nothing, [&] { made->Save(bytes); });
  bool is_restored = true;
  const double restore =
      TimeShortest(options.repeats, nothing, [&] { is_restored = made->Restore(bytes).ok() && is_restored; });
  if (!is_restored) return WrongAnswer("restore", "the state is refused");
  std::uint64_t last = 0;
  const double hashed = TimeShortest(options.repeats, nothing, [&] { last = made->Hash(); });
  if (last != other.Hash()) return WrongAnswer("hash", "the same state has another hash");

  BenchmarkResult result;
  result.notes.push_back("the cholecystectomy on the built-in patient, uncut; memory is what " +
                         std::to_string(kCopies) + " more simulations of its model take, each");
  result.cases = {{"operation/save", 1e3 * save, "ms"},
                  {"operation/restore", 1e3 * restore, "ms"},
                  {"operation/hash", 1e3 * hashed, "ms"},
                  {"operation/bytes", static_cast<double>(bytes.size()), "B"},
                  {"operation/memory_each", 1e-6 * each, "MB"}};
  return result;
}

}  // namespace trocar::bench
