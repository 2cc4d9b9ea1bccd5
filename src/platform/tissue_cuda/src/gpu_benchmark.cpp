// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_benchmark.h"

#include <cmath>
#include <cstdio>

#include "gpu_benchmark_run.h"
#include "host_driver.h"
#include "trocar/host/clock.h"

namespace trocar::tissue_cuda {

using base::Status;
using math::Vec3;

std::string DescribeOptions(const GpuOptions& options) {
  std::string text(LayoutName(options.layout));
  if (options.layout == Layout::kTiled) text += options.forbid_resident ? "-streaming" : "-resident";
  return text + "_" + std::string(PrecisionName(options.precision));
}

std::vector<GpuOptions> AllOptions() {
  std::vector<GpuOptions> all;
  for (const Layout layout : AllLayouts()) {
    for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
      all.push_back({layout, precision, false});
      if (layout == Layout::kTiled) all.push_back({layout, precision, true});
    }
  }
  return all;
}

base::Error WrongAnswer(const std::string& name, const std::string& what) {
  return {base::ErrorCode::kBenchmarkWrong,
          name + ": " + what + "; no time is reported. Run tools/check-gpu"};
}

PaperProblem MakePaperProblem(std::uint32_t n, double shape_stiffness, bool is_scattered) {
  constexpr double kSpacing =
      0.004;  // the steps of the solver are bounded in metres: lengths of an organ's mesh
  tissue::TissueDefinition definition = MakeGridSystem(n, n, Springs::kUniform, kSpacing);
  definition.shape_stiffness.assign(definition.rest.size(), shape_stiffness);
  definition.mass.assign(definition.rest.size(), 0.0);
  definition.fixed.clear();
  PaperProblem problem;
  problem.forces.assign(definition.rest.size(), Vec3{0, 0, -0.001 * kSpacing});
  problem.forces[static_cast<std::size_t>(n / 2) * n + n / 2] = {0, 0, 0.5 * kSpacing};
  for (std::uint32_t i = 0; i < n * n; ++i) {
    const std::uint32_t column = i % n, row = i / n;
    if (column == 0 || row == 0 || column == n - 1 || row == n - 1) definition.fixed.push_back(i);
  }
  if (is_scattered) {
    const std::vector<std::uint32_t> place = MakeRandomOrder(definition.rest.size(), 17);
    std::vector<Vec3> forces(problem.forces.size());
    for (std::size_t i = 0; i < place.size(); ++i) forces[place[i]] = problem.forces[i];
    problem.forces = std::move(forces);
    Renumber(place, definition);
  }
  problem.model = tissue::MakeTissueModel(definition);
  problem.state = tissue::MakeRestState(problem.model);
  return problem;
}

base::Result<GpuAnswer> SolveOnce(GpuSolver& solver, const GpuSettings& settings,
                                  const tissue::TissueLoad& load, const tissue::TissueState& start) {
  tissue::TissueState state = start;
  const host::Stopwatch stopwatch;
  const base::Result<tissue::SolveReport> report = solver.Solve(settings, load, state);
  const double seconds = stopwatch.Seconds();
  if (!report) return report.error();
  return GpuAnswer{std::move(state.position), *report, solver.LastTimes(), seconds};
}

double CalcRelativeError(const std::vector<Vec3>& found, const std::vector<Vec3>& expected,
                         const std::vector<Vec3>& rest) {
  return CalcLargestDistance(found, expected) / CalcLargestDistance(expected, rest);
}

base::Result<GpuBenchmarkResult> RunGpuBenchmark(const GpuBenchmarkOptions& options) {
  GpuBenchmarkRun run{options, BuiltInSource(), {}, {}};
  const base::Result<GpuInformation> gpu = FindGpu(run.source);
  run.result.has_gpu = gpu.ok() && !options.on_host;
  if (run.result.has_gpu) {
    run.result.machine =
        gpu->name + ", " + std::to_string(gpu->multiprocessors) + " multiprocessors, compute capability " +
        std::to_string(gpu->compute_capability / 10) + "." + std::to_string(gpu->compute_capability % 10) +
        ", driver of CUDA " + std::to_string(gpu->driver_version / 1000) + "." +
        std::to_string(gpu->driver_version % 1000 / 10);
  } else {
    run.source = HostSource();
    run.result.machine =
        "no GPU: " + (gpu ? std::string("the host executor was asked for") : gpu.error().Text());
    run.result.notes.push_back(
        "the host executor ran the kernels on the processor: answers are checked, nothing is timed");
  }
  for (Status (*part)(GpuBenchmarkRun&) : {CheckAgainstHost, CheckSteps, CheckEquilibrium}) {
    if (Status status = part(run); !status) return status.error();
  }
  if (!run.result.has_gpu || options.is_quick) return std::move(run.result);
  for (Status (*part)(GpuBenchmarkRun&) : {TimeSteps, TimeFrame, TimeLarge}) {
    if (Status status = part(run); !status) return status.error();
  }
  return std::move(run.result);
}

namespace {

std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted + "\"";
}

std::string Number(double value) {
  if (!std::isfinite(value)) return "null";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace

std::string FormatGpuBenchmark(const GpuBenchmarkResult& result) {
  std::string text = "{\n  \"suite\": \"tissue_cuda\",\n  \"machine\": " + Quoted(result.machine) +
                     ",\n  \"has_gpu\": " + (result.has_gpu ? "true" : "false") + ",\n  \"notes\": [";
  const char* separator = "\n    ";
  for (const std::string& note : result.notes) text += separator + Quoted(note), separator = ",\n    ";
  text += "\n  ],\n  \"cases\": [";
  separator = "\n    ";
  for (const auto& entry : result.cases) {
    text += separator + ("{\"name\": " + Quoted(entry.name)) + ", \"value\": " + Number(entry.value) +
            ", \"unit\": " + Quoted(entry.unit) + "}";
    separator = ",\n    ";
  }
  text += "\n  ],\n  \"ratios\": [";
  separator = "\n    ";
  for (const auto& ratio : result.ratios) {
    text += separator + ("{\"name\": " + Quoted(ratio.name)) + ", \"value\": " + Number(ratio.value) + "}";
    separator = ",\n    ";
  }
  return text + "\n  ]\n}\n";
}

}  // namespace trocar::tissue_cuda
