// SPDX-License-Identifier: Apache-2.0
/// \file benchmark.h  Timing that also checks: a fast wrong answer is an error, not a figure.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/host/clock.h"

namespace trocar::bench {

struct BenchmarkOptions {
  int threads = 1;         ///< of what can use more than one
  int repeats = 5;         ///< the quickest counts
  int attempts = 100'000;  ///< of the store
  int steps = 3000;        ///< random actions of the soak, over all environments
  std::uint64_t seed = 1;  ///< of those actions
  std::string labels;      ///< label map that growth draws its phantom of; empty: of generated patients
  std::string beside;  ///< another build's program, which the operation is timed by turns with; empty: none
  bool judges_errors = true;  ///< whether the operation's ticks are held against their equilibrium, too
  std::string url;  ///< an empty database for the store; empty: a SQLite file for the time of the benchmark
};

struct BenchmarkCase {
  std::string name;
  double value = 0;
  std::string unit;
};

/// How two cases relate [-].
struct BenchmarkRatio {
  std::string name;
  double value = 0;
};

struct BenchmarkResult {
  std::string machine;             ///< in place of DescribeMachine(), where that is not what was measured
  std::vector<std::string> notes;  ///< what a reader must know beside the figures
  std::vector<BenchmarkCase> cases;
  std::vector<BenchmarkRatio> ratios;
};

struct BenchmarkSuite {
  std::string_view name;
  std::string_view description;
  base::Result<BenchmarkResult> (*run)(const BenchmarkOptions& options);
};

/// All suites, in alphabetical order.
std::span<const BenchmarkSuite> BenchmarkSuites() noexcept;

/// \return kBenchmarkWrong when an answer is wrong, or the error of a scene that cannot be read
base::Result<BenchmarkResult> RunAnatomyBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunCollisionBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunContoursBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunElementaryBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunEnvironmentBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunSoakBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunGrowthBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunHapticsBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunOperationBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunRecordingBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunSnapshotBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunStateBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunStoreBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunTissueBenchmark(const BenchmarkOptions& options);
base::Result<BenchmarkResult> RunTissueCudaBenchmark(const BenchmarkOptions& options);

/// Processor, cores, compiler and kind of build; no name of the computer or its owner.
std::string DescribeMachine();

/// As above, from the text of /proc/cpuinfo.
std::string DescribeMachine(std::string_view cpu_info, unsigned cores);

/// Error for a case whose answer is wrong.
base::Error WrongAnswer(std::string_view case_name, std::string_view what);

/// Shortest time of `repeats` runs, after one that does not count [s]; with 0 repeats, of that one.
///
/// \param restore  sets the state back before each run; not timed
template <typename Restore, typename Run>
double TimeShortest(int repeats, const Restore& restore, const Run& run) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= repeats; ++i) {
    restore();
    const host::Stopwatch stopwatch;
    run();
    if (i > 0 || repeats == 0) shortest = std::min(shortest, stopwatch.Seconds());
  }
  return shortest;
}

}  // namespace trocar::bench
