// SPDX-License-Identifier: Apache-2.0
/// \file solver_times.h  Results of the GPU's benchmark, as rows of figures 8 and 9.
#pragma once

#include <string>

#include "trocar/bench/experiment.h"
#include "trocar/tissue_cuda/gpu_benchmark.h"

namespace trocar::bench {

/// One row for each memory layout, in single precision; without times where no GPU ran.
/// \param measured  nullptr where there is no GPU
/// \param note      name of the GPU, or why there is none
void AddGpuRows(const tissue_cuda::GpuBenchmarkResult* measured, const std::string& note, SolverTimes& times);

}  // namespace trocar::bench
