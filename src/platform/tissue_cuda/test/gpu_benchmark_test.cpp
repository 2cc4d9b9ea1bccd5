// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue_cuda/gpu_benchmark.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu_benchmark_run.h"
#include "stand_in.h"

namespace trocar::tissue_cuda {
namespace {

GpuBenchmarkRun MakeRun() {
  GpuBenchmarkRun run{{.repeats = 1, .is_quick = true}, StandIn::Source(), {}, {}};
  run.result.has_gpu = true;
  run.sizes = {{16, 17}, 3, 4, 20, 40, 1 << 16};
  return run;
}

TEST(GpuBenchmark, ChecksEveryLayoutBitForBit) {
  const StandIn stand_in;
  GpuBenchmarkRun run = MakeRun();
  const base::Status status = CheckAgainstHost(run);
  EXPECT_TRUE(status.ok()) << status.error().Text();
  EXPECT_EQ(run.result.notes.size(), 1u);
}

// Negative control: one bit of one copy spoilt, and there is no figure.
TEST(GpuBenchmark, FindsASpoiltBit) {
  const StandIn stand_in("spoil=1");
  GpuBenchmarkRun run = MakeRun();
  const base::Status status = CheckAgainstHost(run);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, base::ErrorCode::kBenchmarkWrong);
}

TEST(GpuBenchmark, PassesOnAnErrorOfTheGpu) {
  const StandIn stand_in("fail=cuLaunchKernel:30:700");
  GpuBenchmarkRun run = MakeRun();
  const base::Status status = CheckAgainstHost(run);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, base::ErrorCode::kGpuFailed);
}

TEST(GpuBenchmark, TimesStepsFramesAndALargeMesh) {
  const StandIn stand_in;
  GpuBenchmarkRun run = MakeRun();
  for (base::Status (*part)(GpuBenchmarkRun&) :
       {CheckSteps, CheckEquilibrium, TimeSteps, TimeFrame, TimeLarge}) {
    const base::Status status = part(run);
    ASSERT_TRUE(status.ok()) << status.error().Text();
  }
  std::vector<std::string> names;
  for (const auto& entry : run.result.cases) {
    names.push_back(entry.name);
    EXPECT_TRUE(std::isfinite(entry.value)) << entry.name;
  }
  EXPECT_THAT(
      names, testing::IsSupersetOf({"error/shared-coalesced_double_1089", "error/tiled_single_irregular_1089",
                                    "iteration/global_single_289", "iteration/tiled-resident_single_256",
                                    "iteration/tiled-streaming_double_256",
                                    "iteration/tiled_single_irregular_289", "frame/20x20_kv0.05",
                                    "frame/20x20_kv0.05_true_error", "large/nodes", "large/bandwidth"}));
  std::vector<std::string> ratios;
  for (const auto& ratio : run.result.ratios) ratios.push_back(ratio.name);
  EXPECT_THAT(ratios,
              testing::ElementsAre("iteration/best_paper_over_tiled_256",
                                   "iteration/best_paper_over_tiled_289", "large/fraction_of_copy_roof"));
}

TEST(GpuBenchmark, FormatsAsJson) {
  GpuBenchmarkResult result;
  result.machine = "a \"GPU\"\n";
  result.notes = {"one", "two"};
  result.cases = {{"a", 1.5, "us"}, {"b", std::nan(""), "1"}};
  result.ratios = {{"r", 2}};
  EXPECT_EQ(FormatGpuBenchmark(result),
            "{\n  \"suite\": \"tissue_cuda\",\n  \"machine\": \"a \\\"GPU\\\" \",\n  \"has_gpu\": false,\n"
            "  \"notes\": [\n    \"one\",\n    \"two\"\n  ],\n  \"cases\": [\n"
            "    {\"name\": \"a\", \"value\": 1.5, \"unit\": \"us\"},\n"
            "    {\"name\": \"b\", \"value\": null, \"unit\": \"1\"}\n  ],\n  \"ratios\": [\n"
            "    {\"name\": \"r\", \"value\": 2}\n  ]\n}\n");
}

}  // namespace
}  // namespace trocar::tissue_cuda
