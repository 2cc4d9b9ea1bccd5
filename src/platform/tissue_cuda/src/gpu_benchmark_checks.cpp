// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "gpu_benchmark_run.h"
#include "host_driver.h"

namespace trocar::tissue_cuda {

using base::Status;
using math::Vec3;

namespace {

/// What the issue of the GPU allows: distance from the processor's answer over the largest displacement [-].
constexpr double kAllowedError = 1e-5;

/// Systems of awkward sizes, with every kind of load where the layout takes it.
struct NamedSystem {
  std::string name;
  tissue::TissueDefinition definition;
};
std::vector<NamedSystem> MakeSystems() {
  std::vector<NamedSystem> systems;
  constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {{1, 1}, {2, 1}, {31, 33}, {16, 16}, {65, 17}};
  for (const auto& size : kSizes) {
    systems.push_back({std::to_string(size.first) + " x " + std::to_string(size.second),
                       MakeGridSystem(size.first, size.second, Springs::kVaried, 0.004)});
  }
  systems.push_back({"sphere of 642", MakeScatteredSphere(3, Springs::kVaried, 0.03)});
  return systems;
}

}  // namespace

// The GPU and the host executor run the same code with the same rounding: not a bit may differ.
Status CheckAgainstHost(GpuBenchmarkRun& run) {
  if (!run.result.has_gpu) return {};
  for (const NamedSystem& system : MakeSystems()) {
    for (const GpuOptions& options : AllOptions()) {
      const bool is_tiled = options.layout == Layout::kTiled;
      const auto given = MakeCase(system.definition, is_tiled);
      const std::string name = system.name + " " + DescribeOptions(options);
      base::Result<GpuSolver> gpu = MakeGpuSolver(given->model, options, run.source);
      if (!gpu && gpu.error().code == base::ErrorCode::kGpuLayout)
        continue;  // a shared layout of an irregular mesh
      if (!gpu) return gpu.error();
      base::Result<GpuSolver> host = MakeGpuSolver(given->model, options, HostSource());
      if (!host) return host.error();
      for (const int iterations : {1, 60}) {
        const GpuSettings settings{iterations, 1e-30};
        const base::Result<GpuAnswer> found = SolveOnce(*gpu, settings, given->load, given->state);
        if (!found) return found.error();
        const base::Result<GpuAnswer> expected = SolveOnce(*host, settings, given->load, given->state);
        if (!expected) return expected.error();
        if (found->position != expected->position || found->report.residual != expected->report.residual) {
          return WrongAnswer(
              name, "other bits than the host executor after " + std::to_string(iterations) +
                        " iterations, by " +
                        std::to_string(CalcLargestDistance(found->position, expected->position)) + " m");
        }
      }
    }
  }
  run.result.notes.push_back(
      "every layout in both precisions gives the host executor's bits, on grids and on an "
      "irregular mesh, with contacts, strands, forces and prescribed nodes");
  return {};
}

// The paper's layouts step for step against the plain evaluation of the balance, which shares nothing with
// them.
Status CheckSteps(GpuBenchmarkRun& run) {
  const std::uint32_t n = run.options.is_quick ? 33 : run.result.has_gpu ? 208 : 112;
  const int steps = run.options.is_quick ? 5 : 50;
  const PaperProblem problem = MakePaperProblem(n, 0.05);
  const tissue::TissueLoad load = problem.Load();
  constexpr double kAlpha = 0.07;  // below the bound 2 / (2 * 8 + 0.05), where steps would grow
  tissue::TissueState expected = problem.state;
  RelaxPlainly(problem.model, load, kAlpha, steps, expected);
  for (const GpuOptions& options : AllOptions()) {
    if (options.layout == Layout::kTiled) continue;
    base::Result<GpuSolver> solver = MakeGpuSolver(problem.model, options, run.source);
    if (!solver) return solver.error();
    const base::Result<GpuAnswer> found = SolveOnce(*solver, {steps, 0.0, kAlpha}, load, problem.state);
    if (!found) return found.error();
    const double error = CalcRelativeError(found->position, expected.position, problem.model.rest);
    const std::string name = "error/" + DescribeOptions(options) + "_" + std::to_string(n * n);
    // stored positions lose the last bits of a coordinate in single precision, as in the paper: reported, not
    // judged
    if (options.precision == Precision::kDouble && !(error <= kAllowedError)) {
      return WrongAnswer(name, "a node is " + std::to_string(error) + " of the largest displacement away");
    }
    run.result.cases.push_back({name, error, "1"});
  }
  return {};
}

// Ours at equilibrium: double precision judged by the plain balance, single precision by double.
Status CheckEquilibrium(GpuBenchmarkRun& run) {
  const std::uint32_t n = run.options.is_quick ? 33 : run.result.has_gpu ? 208 : 64;
  for (const bool is_scattered : {false, true}) {
    const PaperProblem problem = MakePaperProblem(n, 0.05, is_scattered);
    const tissue::TissueLoad load = problem.Load();
    tissue::TissueState truth = problem.state;
    for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
      base::Result<GpuSolver> solver = MakeGpuSolver(problem.model, {Layout::kTiled, precision}, run.source);
      if (!solver) return solver.error();
      const bool is_double = precision == Precision::kDouble;
      const base::Result<GpuAnswer> found =
          SolveOnce(*solver, {5000, is_double ? 1e-9 : 3e-6}, load, problem.state);
      if (!found) return found.error();
      const std::string name = std::string("error/tiled_") + std::string(PrecisionName(precision)) +
                               (is_scattered ? "_irregular_" : "_structured_") + std::to_string(n * n);
      if (is_double) {
        truth.position = found->position;
        std::vector<Vec3> residual(problem.model.Size());
        tissue::CalcResidual(problem.model, truth, load, residual);
        double largest = 0;
        for (std::size_t i = 0; i < residual.size(); ++i) {
          if (truth.condition[i] != tissue::NodeCondition::kPrescribed)
            largest = math::Max(largest, math::Norm(residual[i]));
        }
        const double force = math::Norm(problem.forces[0]);
        if (!(largest <= 1e-4 * force)) {
          return WrongAnswer(name, "a node is out of balance by " + std::to_string(largest / force) +
                                       " of the smallest load");
        }
        continue;
      }
      const double error = CalcRelativeError(found->position, truth.position, problem.model.rest);
      if (!(error <= kAllowedError)) {
        return WrongAnswer(name, "a node is " + std::to_string(error) + " of the largest displacement away");
      }
      run.result.cases.push_back({name, error, "1"});
    }
  }
  return {};
}

}  // namespace trocar::tissue_cuda
