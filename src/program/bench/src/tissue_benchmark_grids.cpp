// SPDX-License-Identifier: Apache-2.0
/// \file tissue_benchmark_grids.cpp  The largest grid of the paper: one iteration, and the way to
/// equilibrium.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tissue_benchmark.h"
#include "trocar/host/threads.h"

namespace trocar::bench {
namespace {

using tissue::SolverKind;
using tissue::SolverSettings;
using tissue::TissueState;

constexpr int kSide = 208;
// the iterations of a solve less those of a shorter one: what a solve costs once does not count
constexpr int kShortRun = 100, kLongRun = 300;
constexpr int kPaperIterations = 4;  // at a time, by turns with ours
constexpr int kPaperCheck = 50;      // iterations between two looks at the relaxation's error
constexpr int kPaperLimit = 20'000;
constexpr double kAllowedError = 5e-4;  // of the largest displacement [-]
constexpr double kWarmError = 0.01;     // of the change [-]
constexpr double kLoosest = 64;         // of the estimates that are tried, a power of two [-]

double LargestDisplacement(const GridCase& grid, const TissueState& state) {
  return CalcDistance(state, grid.start);
}

/// Time of one accelerated iteration [s], by turns with the paper's; every number of threads gives the same
/// bits.
base::Status RunIterations(const std::string& name, const GridCase& grid, bool as_grid,
                           const BenchmarkOptions& options, BenchmarkResult& result) {
  const auto make = [&](int threads) {
    return tissue::EquilibriumSolver(grid.model,
                                     {.threads = host::UseThreads(threads), .recognises_grids = as_grid});
  };
  tissue::EquilibriumSolver solver = make(options.threads);
  SolverSettings settings;
  settings.kind = SolverKind::kAcceleratedDescent;
  settings.max_error = 0;
  // not flat, where a coarse-to-fine start would come first
  TissueState start = grid.start;
  RelaxAsPrinted(grid, 20, start.position);
  TissueState state = start;
  const auto time = [&](tissue::EquilibriumSolver& with, int iterations) {
    settings.max_iterations = iterations;
    state.position = start.position;
    const host::Stopwatch stopwatch;
    (void)with.Solve(settings, grid.Load(), state);
    return stopwatch.Seconds();
  };
  double paper = std::numeric_limits<double>::infinity(), shorter = paper, longer = paper;
  std::vector<math::Vec3> relaxed = start.position;
  for (int repeat = 0; repeat <= 4 * options.repeats; ++repeat) {
    const host::Stopwatch stopwatch;
    RelaxAsPrinted(grid, kPaperIterations, relaxed);
    paper = std::min(paper, stopwatch.Seconds() / kPaperIterations);
    shorter = std::min(shorter, time(solver, kShortRun));
    longer = std::min(longer, time(solver, kLongRun));
  }
  const double ours = (longer - shorter) / (kLongRun - kShortRun);
  tissue::EquilibriumSolver alone = make(1);
  const TissueState together = state;
  (void)time(alone, kLongRun);
  if (state.position != together.position) return WrongAnswer(name, "other bits than with one thread");
  result.cases.push_back({name, 1e6 * ours, "us"});
  result.cases.push_back({name + "/paper", 1e6 * paper, "us"});
  result.ratios.push_back({name + "/vs_paper", paper / ours});
  return {};
}

/// Time of the paper's relaxation to the allowed error [s].
base::Result<double> TimeRelaxation(const std::string& name, const GridCase& grid, const TissueState& truth,
                                    BenchmarkResult& result) {
  TissueState state = grid.start;
  const double scale = LargestDisplacement(grid, truth);
  double seconds = 0;
  for (int iterations = 0; iterations < kPaperLimit; iterations += kPaperCheck) {
    const host::Stopwatch stopwatch;
    RelaxAsPrinted(grid, kPaperCheck, state.position);
    seconds += stopwatch.Seconds();
    if (!(CalcDistance(state, truth) < kAllowedError * scale)) continue;
    result.cases.push_back({name + "/paper", 1e3 * seconds, "ms"});
    return seconds;
  }
  return WrongAnswer(name, "the paper's relaxation does not get there");
}

base::Status AddSolve(const std::string& name, double seconds, const tissue::SolveReport& report,
                      double error, double allowed, BenchmarkResult& result) {
  if (!(error < allowed)) return WrongAnswer(name, "the true error is " + std::to_string(error));
  result.cases.push_back({name, 1e3 * seconds, "ms"});
  result.cases.push_back({name + "/iterations", static_cast<double>(report.iterations), "1"});
  result.cases.push_back({name + "/true_error", error, "1"});
  return {};
}

/// From flat to the allowed error with the solver that runs.
base::Result<TissueState> RunCold(const std::string& name, const GridCase& grid,
                                  const BenchmarkOptions& options, double& seconds, BenchmarkResult& result) {
  tissue::EquilibriumSolver solver(grid.model, {.threads = host::UseThreads(options.threads)});
  const SolverSettings settings;
  TissueState state = grid.start;
  tissue::SolveReport report;
  seconds = TimeShortest(
      options.repeats, [&] { state.position = grid.start.position; },
      [&] { report = solver.Solve(settings, grid.Load(), state); });
  base::Result<TissueState> truth = FindTruth(name, grid, state);
  if (!truth) return truth.error();
  const double error = CalcDistance(state, *truth) / LargestDisplacement(grid, *truth);
  if (base::Status status = AddSolve(name, seconds, report, error, kAllowedError, result); !status)
    return status.error();
  return truth;
}

/// From equilibrium, with one node moved across the grid by an edge length: to the allowed part of the change by the
/// truth, as the relaxation is timed above, and as far as the solver goes by its own estimate.
base::Status RunWarm(const std::string& name, const GridCase& grid, const TissueState& equilibrium,
                     const BenchmarkOptions& options, BenchmarkResult& result) {
  TissueState moved = equilibrium;
  const std::size_t node = kSide / 4 * kSide + kSide / 4;
  moved.condition[node] = tissue::NodeCondition::kPrescribed;
  moved.position[node].z += 1.0;
  tissue::EquilibriumSolver solver(grid.model, {.threads = host::UseThreads(options.threads)});
  SolverSettings settings;
  TissueState state = moved;
  tissue::SolveReport report;
  const auto solve = [&] { report = solver.Solve(settings, grid.Load(), state); };
  const auto begin = [&] { state.position = moved.position; };
  // max_error is of the largest displacement, not of the change
  const double own_error = 0.5 * kWarmError / LargestDisplacement(grid, equilibrium);
  settings.max_error = own_error;
  solve();
  base::Result<TissueState> truth = FindTruth(name, grid, state);
  if (!truth) return truth.error();
  const double change = CalcDistance(*truth, equilibrium);
  const auto add = [&](const std::string& as) {
    const double seconds = TimeShortest(options.repeats, begin, solve);
    return AddSolve(as, seconds, report, CalcDistance(state, *truth) / change, kWarmError, result);
  };
  if (base::Status status = add(name + "/by_estimate"); !status) return status;
  // the loosest that does: the estimate is a bound, and the truth is far below it
  for (settings.max_error = kLoosest * own_error; settings.max_error > own_error; settings.max_error *= 0.5) {
    begin();
    solve();
    if (CalcDistance(state, *truth) < kWarmError * change) break;
  }
  return add(name);
}

}  // namespace

base::Status RunIterationCases(const BenchmarkOptions& options, BenchmarkResult& result) {
  const GridCase grid = MakeGridCase(kSide, 0.05);
  base::Status status = RunIterations("iteration/structured_43264", grid, true, options, result);
  if (!status) return status;
  return RunIterations("iteration/irregular_43264", grid, false, options, result);
}

base::Status RunEquilibriumCases(const BenchmarkOptions& options, BenchmarkResult& result) {
  const std::string held = "equilibrium/208x208_kv0.05", loose = "equilibrium/208x208_kv0";
  double seconds = 0;
  const GridCase with_shape = MakeGridCase(kSide, 0.05);
  const auto truth = RunCold(held, with_shape, options, seconds, result);
  if (!truth) return truth.error();
  const auto paper = TimeRelaxation(held, with_shape, *truth, result);
  if (!paper) return paper.error();
  result.ratios.push_back({held + "/vs_paper", *paper / seconds});

  const GridCase without = MakeGridCase(kSide, 0.0);
  const auto equilibrium = RunCold(loose + "/cold", without, options, seconds, result);
  if (!equilibrium) return equilibrium.error();
  return RunWarm(loose + "/warm", without, *equilibrium, options, result);
}

}  // namespace trocar::bench
