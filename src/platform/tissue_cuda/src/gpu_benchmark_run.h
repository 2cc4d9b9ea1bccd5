// SPDX-License-Identifier: Apache-2.0
/// \file gpu_benchmark_run.h  Data and functions that the checks and the timings of the GPU benchmark share.
#pragma once

#include <string>
#include <vector>

#include "check_systems.h"
#include "gpu_solve.h"
#include "trocar/tissue_cuda/gpu_benchmark.h"

namespace trocar::tissue_cuda {

/// Sizes of the problems that are timed: the paper's meshes (its Table 1), unless a test asks for less.
struct GpuBenchmarkSizes {
  std::vector<std::uint32_t> sides = {16, 112, 176, 208};  ///< of the grids whose steps are timed
  int steps = 50;                   ///< of the paper's layouts: as many as go without a look at the residual
  int iterations = 1000;            ///< of ours: one launch
  std::uint32_t frame_side = 208;   ///< of the grid that is brought to equilibrium
  std::uint32_t large_side = 1000;  ///< of the grid that does not stay resident
  std::size_t copy_bytes = std::size_t{2} << 30;  ///< to measure the roof of memory
};

/// One run of the benchmark.
struct GpuBenchmarkRun {
  GpuBenchmarkOptions options;
  DriverSource source;  ///< of the GPU, or of the host executor
  GpuBenchmarkResult result;
  GpuBenchmarkSizes sizes;
};

/// "tiled-streaming single", and so on.
std::string DescribeOptions(const GpuOptions& options);
/// Every layout in both precisions, ours resident and streaming.
std::vector<GpuOptions> AllOptions();

base::Error WrongAnswer(const std::string& name, const std::string& what);

/// The paper's experiment: an n x n grid with springs of 1 N/m, border fixed, a small load on every node and
/// a large one the other way at the centre. Lengths and forces in units of the spacing are those of unit
/// spacing.
struct PaperProblem {
  tissue::TissueModel model;
  tissue::TissueState state;
  std::vector<math::Vec3> forces;

  tissue::TissueLoad Load() const {
    tissue::TissueLoad load;
    load.external_force = forces;
    return load;
  }
};
/// \param is_scattered  nodes numbered at random, as an irregular mesh
PaperProblem MakePaperProblem(std::uint32_t n, double shape_stiffness, bool is_scattered = false);

/// One solve from the problem's state.
struct GpuAnswer {
  std::vector<math::Vec3> position;
  tissue::SolveReport report;
  GpuTimes times;
  double wall_seconds = 0;
};
base::Result<GpuAnswer> SolveOnce(GpuSolver& solver, const GpuSettings& settings,
                                  const tissue::TissueLoad& load, const tissue::TissueState& start);

/// Largest distance of any node from where it should be, over the largest displacement.
double CalcRelativeError(const std::vector<math::Vec3>& found, const std::vector<math::Vec3>& expected,
                         const std::vector<math::Vec3>& rest);

// checks (gpu_benchmark_checks.cpp)
base::Status CheckAgainstHost(GpuBenchmarkRun& run);
base::Status CheckSteps(GpuBenchmarkRun& run);
base::Status CheckEquilibrium(GpuBenchmarkRun& run);

// timings (gpu_benchmark_times.cpp)
base::Status TimeSteps(GpuBenchmarkRun& run);
base::Status TimeFrame(GpuBenchmarkRun& run);
base::Status TimeLarge(GpuBenchmarkRun& run);

}  // namespace trocar::tissue_cuda
