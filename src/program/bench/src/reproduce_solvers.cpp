// SPDX-License-Identifier: Apache-2.0
/// \file reproduce_solvers.cpp  Figures 8 and 9: time of an iteration of every solver and every GPU layout over mesh
/// size, and its speed-up over the paper's relaxation.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "processor_time.h"
#include "solver_times.h"
#include "tissue_benchmark.h"
#include "trocar/bench/benchmark.h"
#include "trocar/bench/experiment.h"
#include "trocar/host/text_table.h"
#include "trocar/host/threads.h"
#include "trocar/tissue_cuda/gpu_benchmark.h"
#include "trocar/tissue_cuda/gpu_solver.h"

namespace trocar::bench {
namespace {

using tissue::SolverKind;
using tissue::SolverSettings;

constexpr double kVirtualStiffness = 0.05;
/// Node updates of one run: small meshes take more iterations, so that a clock's grain does not matter.
constexpr double kNodeUpdates = 4e6, kQuickNodeUpdates = 2e5;
constexpr const char* kPaperLimit = "below 16 ms a frame at 43,264 points (text)";

struct Contender {
  const char* name;
  SolverKind kind;
  bool recognises_grids;
  const char* note;
};
constexpr std::array<Contender, 6> kContenders = {{
    {"relaxation", SolverKind::kRelaxationPaper, true, "with residual and force scale"},
    {"gauss_seidel", SolverKind::kGaussSeidelBrown2001, true, "a sweep over all nodes"},
    {"chebyshev", SolverKind::kChebyshevJacobi2015, true, "double precision, any mesh"},
    {"accelerated, irregular", SolverKind::kAcceleratedDescent, false, "single precision, any mesh"},
    {"accelerated, structured", SolverKind::kAcceleratedDescent, true, "single precision, grids"},
    {"newton", SolverKind::kNewtonMultigrid, true, "a step, its conjugate gradients included"},
}};

/// Time of one iteration [s]: a long run less a short one, so that what a solve costs once does not count.
base::Result<double> TimeIteration(const GridCase& grid, const Contender& contender, int iterations,
                                   const ExperimentOptions& options) {
  tissue::EquilibriumSolver solver(grid.model, {.threads = host::UseThreads(options.threads),
                                                .recognises_grids = contender.recognises_grids});
  SolverSettings settings;
  settings.kind = contender.kind;
  settings.tolerance = settings.max_error = 0;
  // not flat, where a coarse-to-fine start would come first
  tissue::TissueState start = grid.start;
  RelaxAsPrinted(grid, 20, start.position);
  const double energy = tissue::CalcEnergy(grid.model, start, grid.Load());
  tissue::TissueState state = start;
  int counted = 0;
  const auto time = [&](int count) {
    settings.max_iterations = settings.newton.max_steps = count;
    return TimeShortestWork(
        options.threads, options.is_quick ? 1 : options.repeats, [&] { state.position = start.position; },
        [&] { counted = solver.Solve(settings, grid.Load(), state).iterations; });
  };
  const bool is_newton = contender.kind == SolverKind::kNewtonMultigrid;
  const int shorter = is_newton ? 1 : std::max(1, iterations / 4);
  const double short_seconds = time(shorter);
  const int short_counted = counted;
  const double long_seconds = time(is_newton ? 4 : shorter + iterations);
  if (!(tissue::CalcEnergy(grid.model, state, grid.Load()) < energy))
    return WrongAnswer(std::string("fig8/") + contender.name, "the energy did not go down");
  return std::max(0.0, long_seconds - short_seconds) / std::max(1, counted - short_counted);
}

base::Result<SolverTimes> MeasureSolvers(const ExperimentOptions& options) {
  SolverTimes times;
  times.sides = options.is_quick ? std::vector<int>{16, 48} : std::vector<int>{16, 112, 176, 208};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  times.rows.push_back({"paper's relaxation", "scalar, double precision, nothing but the update", {}});
  for (const Contender& contender : kContenders) times.rows.push_back({contender.name, contender.note, {}});
  double done = 0;
  for (const int side : times.sides) {
    const GridCase grid = MakeGridCase(side, kVirtualStiffness);
    const double updates = options.is_quick ? kQuickNodeUpdates : kNodeUpdates;
    const int iterations = std::max(20, static_cast<int>(updates / (side * side)));
    std::vector<math::Vec3> relaxed = grid.start.position;
    times.rows[0].seconds.push_back(TimeShortestWork(
                                        1, options.is_quick ? 1 : options.repeats,
                                        [&] { relaxed = grid.start.position; },
                                        [&] { RelaxAsPrinted(grid, iterations, relaxed); }) /
                                    iterations);
    for (std::size_t i = 0; i < kContenders.size(); ++i) {
      const auto seconds = TimeIteration(grid, kContenders[i], iterations, options);
      if (!seconds) return seconds.error();
      times.rows[i + 1].seconds.push_back(*seconds > 0.0 ? *seconds : nan);
      options.progress(++done / static_cast<double>(times.sides.size() * (kContenders.size() + 1)));
    }
  }
  if (const auto gpu = tissue_cuda::FindGpu(); !gpu) {
    AddGpuRows(nullptr, "no GPU here: not measured (" + gpu.error().message + ")", times);
  } else {
    const auto measured = tissue_cuda::RunGpuBenchmark({.repeats = options.repeats});
    if (!measured) return measured.error();
    AddGpuRows(&*measured, measured->machine, times);
  }
  return times;
}

base::Result<const SolverTimes*> FindTimes(const ExperimentOptions& options, ExperimentStore& store) {
  if (!store.solver_times) {
    auto measured = MeasureSolvers(options);
    if (!measured) return measured.error();
    store.solver_times = std::move(measured).value();
  }
  return &*store.solver_times;
}

std::vector<std::string> MakeHeading(const SolverTimes& times, const std::string& unit) {
  std::vector<std::string> heading = {"solver"};
  for (const int side : times.sides) heading.push_back(std::to_string(side * side) + " points" + unit);
  heading.emplace_back("paper");
  heading.emplace_back("an iteration is");
  return heading;
}

/// One row and one line per solver; `value` of the seconds of a row on the s-th mesh.
template <typename Value>
void AddRows(const SolverTimes& times, const Value& value, ExperimentTable& table,
             std::vector<PlotLine>& lines) {
  for (const SolverTimes::Row& row : times.rows) {
    table.rows.push_back({row.solver});
    PlotLine line{row.solver, {}};
    for (std::size_t s = 0; s < times.sides.size(); ++s) {
      const double found = row.seconds.empty() ? NAN : value(row, s);
      table.rows.back().emplace_back(found, 3);
      line.points.push_back({double(times.sides[s] * times.sides[s]), found});
    }
    table.rows.back().emplace_back(kNotReadable);
    table.rows.back().emplace_back(row.note);
    const bool is_measured = std::any_of(line.points.begin(), line.points.end(),
                                         [](const math::Vec2& point) { return std::isfinite(point.y); });
    if (is_measured && lines.size() < 8) lines.push_back(std::move(line));
  }
}

std::string DescribeProblem(const ExperimentOptions& options) {
  return "The four grids of Table 1: unit spacing, springs of 1 N/m on every edge, k_virtual 0.05, border "
         "held, 0.001 N "
         "on every node and 0.5 N at the centre the other way. Solvers with " +
         std::to_string(options.threads) + (options.threads == 1 ? " thread" : " threads") +
         "; processor time where it is one, a long run less a short one, the quickest of " +
         std::to_string(options.is_quick ? 1 : options.repeats) +
         ". After each the stored energy must be lower than before.";
}

}  // namespace

void AddGpuRows(const tissue_cuda::GpuBenchmarkResult* measured, const std::string& note,
                SolverTimes& times) {
  for (const tissue_cuda::Layout layout : tissue_cuda::AllLayouts()) {
    const std::string name(tissue_cuda::LayoutName(layout));
    SolverTimes::Row row{"GPU, " + name, note, {}, true};
    for (const int side : times.sides) {
      double seconds = std::numeric_limits<double>::quiet_NaN();
      if (measured != nullptr && measured->has_gpu) {
        const std::string wanted = "iteration/" + name + "_single_" + std::to_string(side * side);
        for (const auto& entry : measured->cases) {
          if (entry.name == wanted && entry.unit == "us") seconds = 1e-6 * entry.value;
        }
      }
      row.seconds.push_back(seconds);
    }
    times.rows.push_back(std::move(row));
  }
}

ExperimentResult ReproduceFigure8(const ExperimentOptions& options, ExperimentStore& store) {
  const auto found = FindTimes(options, store);
  if (!found) return found.error();
  Experiment experiment{"fig8",
                        "Figure 8: time of an iteration over mesh size",
                        DescribeProblem(options),
                        {},
                        {std::string("The curves stand only in the paper's picture; its text says: ") +
                             kPaperLimit + ", on a GeForce 8800 GT.",
                         "Iterations of different solvers do not do the same work: what counts is the time "
                         "to equilibrium (experiment "
                         "equilibrium).",
                         "A row without a GPU has no time: the host executor checks the kernels and is no "
                         "measure of their speed."},
                        {}};
  ExperimentTable table{"Time of one iteration [us]", MakeHeading(**found, ""), {}};
  std::vector<PlotLine> lines;
  AddRows(
      **found, [](const SolverTimes::Row& row, std::size_t s) { return 1e6 * row.seconds[s]; }, table, lines);
  experiment.tables = {table};
  PlotSettings settings{"Time of one iteration", "points", "time [us]"};
  settings.is_log_x = settings.is_log_y = true;
  settings.height = 320;
  experiment.plots = {{settings, lines}};
  return experiment;
}

ExperimentResult ReproduceFigure9(const ExperimentOptions& options, ExperimentStore& store) {
  const auto found = FindTimes(options, store);
  if (!found) return found.error();
  const SolverTimes& times = **found;
  Experiment experiment{
      "fig9",
      "Figure 9: speed-up over the paper's relaxation",
      DescribeProblem(options) +
          " Time of the paper's relaxation, scalar in double precision, over that of each solver.",
      {},
      {"The curves stand only in the paper's picture; its text says that shared with coalesced memory was "
       "the fastest "
       "of its four layouts.",
       "A row without a GPU has no time: the host executor checks the kernels and is no measure of their "
       "speed."},
      {}};
  ExperimentTable table{"Speed-up of one iteration [times]", MakeHeading(times, ""), {}};
  std::vector<PlotLine> lines;
  AddRows(
      times,
      [&](const SolverTimes::Row& row, std::size_t s) { return times.rows[0].seconds[s] / row.seconds[s]; },
      table, lines);
  experiment.tables = {table};
  PlotSettings settings{"Speed-up of one iteration", "points", "times"};
  settings.is_log_x = settings.is_log_y = true;
  settings.height = 320;
  experiment.plots = {{settings, lines}};
  return experiment;
}

}  // namespace trocar::bench
