// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>

#include "gpu_benchmark_run.h"
#include "tiled_arrays.h"

namespace trocar::tissue_cuda {

using base::Status;

namespace {

constexpr double kShapeStiffness = 0.05;  // [N/m]

/// Shortest of some solves.
struct Times {
  double kernels = std::numeric_limits<double>::infinity(), wall = kernels;  ///< [s]
};

base::Result<Times> TimeSolves(GpuBenchmarkRun& run, GpuSolver& solver, const GpuSettings& settings,
                               const PaperProblem& problem) {
  const tissue::TissueLoad load = problem.Load();
  Times times;
  for (int repeat = 0; repeat <= run.options.repeats; ++repeat) {
    const base::Result<GpuAnswer> answer = SolveOnce(solver, settings, load, problem.state);
    if (!answer) return answer.error();
    if (repeat == 0) continue;  // warms up
    times.kernels = std::min(times.kernels, answer->times.kernels);
    times.wall = std::min(times.wall, answer->wall_seconds);
  }
  return times;
}

/// Time of one step or iteration by the GPU's clock [s].
base::Result<double> TimeStep(GpuBenchmarkRun& run, const PaperProblem& problem, const GpuOptions& options) {
  base::Result<GpuSolver> solver = MakeGpuSolver(problem.model, options, run.source);
  if (!solver) return solver.error();
  const int count = options.layout == Layout::kTiled ? run.sizes.iterations : run.sizes.steps;
  const base::Result<Times> times = TimeSolves(run, *solver, {count, 0.0}, problem);
  if (!times) return times.error();
  return times->kernels / count;
}

/// Copying within the GPU's memory: the roof that a memory-bound kernel has [B/s], read and written bytes
/// together.
base::Result<double> MeasureCopyRoof(GpuBenchmarkRun& run) {
  base::Result<std::unique_ptr<Gpu>> gpu = Gpu::Open(run.source);
  if (!gpu) return gpu.error();
  const std::size_t bytes =
      std::min<std::size_t>(run.sizes.copy_bytes, (*gpu)->Information().memory_bytes / 8 / 256 * 256);
  base::Result<CudaAddress> a = (*gpu)->Allocate(bytes);
  if (!a) return a.error();
  base::Result<CudaAddress> b = (*gpu)->Allocate(bytes);
  double best = std::numeric_limits<double>::infinity();
  Status status = b ? (*gpu)->Clear(*a, bytes) : Status(b.error());
  for (int repeat = 0; status && repeat < 5; ++repeat) {
    status = (*gpu)->Mark(0);
    if (status) status = (*gpu)->CopyWithinGpu(*b, *a, bytes);
    if (status) status = (*gpu)->Mark(1);
    if (status) status = (*gpu)->Finish();
    if (status && repeat > 0) best = std::min(best, (*gpu)->SecondsBetween(0, 1));
  }
  (*gpu)->Free(*a);
  if (b) (*gpu)->Free(*b);
  if (!status) return status.error();
  return 2.0 * static_cast<double>(bytes) / best;
}

/// Bytes that one iteration of the streaming kernel must move through the GPU's memory, each array once.
double CountBytes(const TiledArrays<float>& arrays) {
  const double node = 3 * sizeof(Quad<float>)     // displacement, the one before, the next
                      + 3 * sizeof(Quad<float>);  // constants
  const double link = sizeof(Quad<float>) + sizeof(LengthExcess<float>) + sizeof(std::uint32_t);
  return node * static_cast<double>(arrays.model_index.size()) +
         link * static_cast<double>(arrays.link_others.size());
}

}  // namespace

// The paper's Figures 8 and 9: time of a step over mesh size, for each layout and for ours.
Status TimeSteps(GpuBenchmarkRun& run) {
  for (const std::uint32_t n : run.sizes.sides) {
    const PaperProblem problem = MakePaperProblem(n, kShapeStiffness);
    const PaperProblem irregular = MakePaperProblem(n, kShapeStiffness, true);
    const std::string size = std::to_string(n * n);
    double best_paper = std::numeric_limits<double>::infinity(), ours = best_paper;
    for (const GpuOptions& options : AllOptions()) {
      const base::Result<double> seconds = TimeStep(run, problem, options);
      if (!seconds) return seconds.error();
      run.result.cases.push_back(
          {"iteration/" + DescribeOptions(options) + "_" + size, 1e6 * *seconds, "us"});
      if (options.precision != Precision::kSingle) continue;
      double& best = options.layout == Layout::kTiled ? ours : best_paper;
      best = std::min(best, *seconds);
    }
    const base::Result<double> seconds = TimeStep(run, irregular, {});
    if (!seconds) return seconds.error();
    run.result.cases.push_back({"iteration/tiled_single_irregular_" + size, 1e6 * *seconds, "us"});
    run.result.ratios.push_back({"iteration/best_paper_over_tiled_" + size, best_paper / ours});
  }
  return {};
}

// A whole frame: from flat to a true error below 0.0005, copies to and fro included.
Status TimeFrame(GpuBenchmarkRun& run) {
  constexpr double kWantedError = 0.0005;
  const std::uint32_t n = run.sizes.frame_side;
  const PaperProblem problem = MakePaperProblem(n, kShapeStiffness);
  const std::string name = "frame/" + std::to_string(n) + "x" + std::to_string(n) + "_kv0.05";
  const tissue::TissueLoad load = problem.Load();
  base::Result<GpuSolver> exact =
      MakeGpuSolver(problem.model, {Layout::kTiled, Precision::kDouble}, run.source);
  if (!exact) return exact.error();
  const base::Result<GpuAnswer> truth = SolveOnce(*exact, {20'000, 1e-10}, load, problem.state);
  if (!truth) return truth.error();
  base::Result<GpuSolver> solver = MakeGpuSolver(problem.model, {}, run.source);
  if (!solver) return solver.error();
  // the fewest iterations, in steps of a tenth, that lead there
  GpuSettings settings{20, 0.0};
  double error = 1;
  for (; settings.max_iterations < 5000; settings.max_iterations += 1 + settings.max_iterations / 10) {
    const base::Result<GpuAnswer> answer = SolveOnce(*solver, settings, load, problem.state);
    if (!answer) return answer.error();
    error = CalcRelativeError(answer->position, truth->position, problem.model.rest);
    if (error < kWantedError) break;
  }
  if (!(error < kWantedError)) return WrongAnswer(name, "the equilibrium is not reached");
  const base::Result<Times> times = TimeSolves(run, *solver, settings, problem);
  if (!times) return times.error();
  run.result.cases.push_back({name, 1e3 * times->wall, "ms"});
  run.result.cases.push_back({name + "_on_gpu", 1e3 * times->kernels, "ms"});
  run.result.cases.push_back({name + "_iterations", double(settings.max_iterations), "1"});
  run.result.cases.push_back({name + "_true_error", error, "1"});
  return {};
}

// A million nodes: more than stay resident, so memory is the roof.
Status TimeLarge(GpuBenchmarkRun& run) {
  const base::Result<double> roof = MeasureCopyRoof(run);
  if (!roof) return roof.error();
  const PaperProblem problem = MakePaperProblem(run.sizes.large_side, kShapeStiffness);
  const base::Result<TiledArrays<float>> arrays = MakeTiledArrays<float>(problem.model);
  if (!arrays) return arrays.error();
  const base::Result<double> seconds = TimeStep(run, problem, {Layout::kTiled, Precision::kSingle, true});
  if (!seconds) return seconds.error();
  run.result.cases.push_back({"large/nodes", static_cast<double>(problem.model.Size()), "1"});
  const double bandwidth = CountBytes(*arrays) / *seconds;
  run.result.cases.push_back({"large/iteration", 1e6 * *seconds, "us"});
  run.result.cases.push_back({"large/bytes_an_iteration", 1e-6 * CountBytes(*arrays), "MB"});
  run.result.cases.push_back({"large/bandwidth", 1e-9 * bandwidth, "GB/s"});
  run.result.cases.push_back({"large/copy_roof", 1e-9 * *roof, "GB/s"});
  run.result.ratios.push_back({"large/fraction_of_copy_roof", bandwidth / *roof});
  return {};
}

}  // namespace trocar::tissue_cuda
