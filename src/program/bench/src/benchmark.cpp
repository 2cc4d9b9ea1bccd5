// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/benchmark.h"

namespace trocar::bench {
namespace {

constexpr BenchmarkSuite kSuites[] = {
    {"anatomy", "label maps to smooth closed meshes with their quality reports", RunAnatomyBenchmark},
    {"collision", "nearest triangle to a point and to a shaft: both hierarchies against brute force",
     RunCollisionBenchmark},
    {"contours", "the contour window: refit while a point is dragged, preview of an organ",
     RunContoursBenchmark},
    {"elementary", "sine, exponential, power and their like: our own beside the C library's",
     RunElementaryBenchmark},
    {"environments", "environments for learning: ticks a second, pictures, a pool beside processes, memory",
     RunEnvironmentBenchmark},
    {"growth",
     "a simulated user grows liver and gallbladder on CT phantoms: Dice, corrections (--repeats, --labels)",
     RunGrowthBenchmark},
    {"haptics", "the 1 kHz loop with both hands in contact, beside a bare loop", RunHapticsBenchmark},
    {"operation",
     "the tick in fixed parts of an operation, and its true error; beside another build by turns (--beside)",
     RunOperationBenchmark},
    {"recording", "what recording costs a tick; how quickly a replay runs, seeks and branches",
     RunRecordingBenchmark},
    {"snapshot", "a tick of the operation as bytes for a network: whole, as a difference, for pictures",
     RunSnapshotBenchmark},
    {"soak",
     "random actions, pedals too, in every environment, each twice: finite and the same states, no growth "
     "(--steps, --seed)",
     RunSoakBenchmark},
    {"state", "saving, restoring and comparing a whole operation; memory of one more", RunStateBenchmark},
    {"store", "history pages and group percentiles in the store of a large centre (--attempts, --url)",
     RunStoreBenchmark},
    {"tissue", "equilibrium of mass-spring grids and of the built-in patient", RunTissueBenchmark},
    {"tissue_cuda", "the GPU's memory layouts: checked, and timed where there is a GPU",
     RunTissueCudaBenchmark},
};

/// Value of the first line "key : value".
std::string FindField(std::string_view text, std::string_view key) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const std::size_t colon = line.find(": ");
    if (line.starts_with(key) && colon != std::string_view::npos) return std::string(line.substr(colon + 2));
    at = end + 1;
  }
  return {};
}

}  // namespace

std::span<const BenchmarkSuite> BenchmarkSuites() noexcept {
  return kSuites;
}

base::Error WrongAnswer(std::string_view case_name, std::string_view what) {
  return {base::ErrorCode::kBenchmarkWrong, std::string(case_name) + ": " + std::string(what) +
                                                "; no time is reported. Run the tests (./test)"};
}

std::string DescribeMachine(std::string_view cpu_info, unsigned cores) {
  std::string model = FindField(cpu_info, "model name");
  if (model.empty()) model = FindField(cpu_info, "Model");
  if (model.empty()) model = "unknown processor";
  return model + ", " + std::to_string(cores) + (cores == 1 ? " core" : " cores");
}

}  // namespace trocar::bench
