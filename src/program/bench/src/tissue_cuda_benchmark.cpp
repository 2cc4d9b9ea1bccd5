// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "trocar/bench/benchmark.h"
#include "trocar/tissue_cuda/gpu_benchmark.h"

namespace trocar::bench {

base::Result<BenchmarkResult> RunTissueCudaBenchmark(const BenchmarkOptions& options) {
  base::Result<tissue_cuda::GpuBenchmarkResult> measured =
      tissue_cuda::RunGpuBenchmark({.repeats = options.repeats});
  if (!measured) return measured.error();
  BenchmarkResult result;
  result.machine = measured->machine + "; host: " + DescribeMachine();
  result.notes = std::move(measured->notes);
  for (const auto& entry : measured->cases) result.cases.push_back({entry.name, entry.value, entry.unit});
  for (const auto& ratio : measured->ratios) result.ratios.push_back({ratio.name, ratio.value});
  return result;
}

}  // namespace trocar::bench
