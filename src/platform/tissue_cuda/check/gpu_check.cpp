// SPDX-License-Identifier: Apache-2.0
/// \file gpu_check.cpp  The GPU's checks and timings as a program of its own, for machines that lack what the
/// trocar command needs (tools/check-gpu).
#include <cstdio>
#include <cstdlib>
#include <string>

#include "trocar/tissue_cuda/gpu_benchmark.h"

namespace {

constexpr const char* kUsage =
    "gpu_check [--quick] [--host] [--need-gpu] [--repeats N] [--json FILE]\n"
    "\n"
    "Checks that every memory layout computes on the GPU what the processor does, and times each.\n"
    "  --quick       small systems and checks alone, for a memory checker\n"
    "  --host        the host executor even where there is a GPU: checks, no times\n"
    "  --need-gpu    exit status 3 where there is no GPU\n"
    "  --repeats N   the quickest of N runs counts, 5 unless said otherwise\n"
    "  --json FILE   write the result there as well\n";

}  // namespace

int main(int argc, char** argv) {
  trocar::tissue_cuda::GpuBenchmarkOptions options;
  bool needs_gpu = false;
  std::string file_name;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--quick") {
      options.is_quick = true;
    } else if (argument == "--host") {
      options.on_host = true;
    } else if (argument == "--need-gpu") {
      needs_gpu = true;
    } else if (argument == "--repeats" && i + 1 < argc) {
      options.repeats = std::atoi(argv[++i]);
    } else if (argument == "--json" && i + 1 < argc) {
      file_name = argv[++i];
    } else {
      std::fputs(kUsage, argument == "--help" || argument == "-h" ? stdout : stderr);
      return argument == "--help" || argument == "-h" ? 0 : 2;
    }
  }
  if (options.repeats < 1) {
    std::fputs("gpu_check: --repeats wants a whole number from 1\n", stderr);
    return 2;
  }
  const auto result = trocar::tissue_cuda::RunGpuBenchmark(options);
  if (!result) {
    std::fprintf(stderr, "gpu_check: %s\n", result.error().Text().c_str());
    return 1;
  }
  const std::string text = trocar::tissue_cuda::FormatGpuBenchmark(*result);
  std::fputs(text.c_str(), stdout);
  if (!file_name.empty()) {
    std::FILE* const file = std::fopen(file_name.c_str(), "w");
    if (file == nullptr || std::fputs(text.c_str(), file) < 0 || std::fclose(file) != 0) {
      std::fprintf(stderr, "gpu_check: cannot write %s\n", file_name.c_str());
      return 1;
    }
  }
  if (!result->has_gpu) std::fprintf(stderr, "gpu_check: %s\n", result->machine.c_str());
  return needs_gpu && !result->has_gpu ? 3 : 0;
}
