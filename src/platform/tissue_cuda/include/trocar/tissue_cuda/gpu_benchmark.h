// SPDX-License-Identifier: Apache-2.0
/// \file gpu_benchmark.h  How fast the GPU is in each memory layout, and whether it is right: a wrong answer
/// is an error and no figure. Without a GPU the host executor runs the same kernels: then answers are checked
/// and nothing is timed.
#pragma once

#include <string>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::tissue_cuda {

struct GpuBenchmarkOptions {
  int repeats = 5;        ///< the quickest counts, >= 1
  bool is_quick = false;  ///< small systems, checks alone: for a memory checker, under which all is slow
  bool on_host = false;   ///< the host executor even where there is a GPU
};

struct GpuBenchmarkResult {
  struct Case {
    std::string name;
    double value;
    std::string unit;
  };
  struct Ratio {
    std::string name;
    double value;
  };
  bool has_gpu = false;            ///< whether a GPU ran; without one there are no times
  std::string machine;             ///< name of the GPU and its driver, or that there is none and why
  std::vector<std::string> notes;  ///< what was checked
  std::vector<Case> cases;
  std::vector<Ratio> ratios;
};

/// \return kBenchmarkWrong when an answer is wrong; kGpuFailed or kGpuMemory when the GPU fails on the way. A
/// missing GPU is no error.
base::Result<GpuBenchmarkResult> RunGpuBenchmark(const GpuBenchmarkOptions& options);

/// {"suite", "machine", "has_gpu", "notes", "cases": [{name, value, unit}], "ratios": [{name, value}]}
std::string FormatGpuBenchmark(const GpuBenchmarkResult& result);

}  // namespace trocar::tissue_cuda
