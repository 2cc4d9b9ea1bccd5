// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/benchmark.h"

#include <gtest/gtest.h>

#include <string_view>

namespace trocar::bench {
namespace {

TEST(DescribeMachine, NamesProcessorAndCoresAndNothingElse) {
  const char* text = "processor\t: 0\nvendor_id\t: X\nmodel name\t: Example CPU @ 2.00GHz\nprocessor\t: 1\n";
  EXPECT_EQ(DescribeMachine(text, 2), "Example CPU @ 2.00GHz, 2 cores");
  EXPECT_EQ(DescribeMachine("", 1), "unknown processor, 1 core");
}

TEST(TimeShortest, WarmsUpAndRestoresBeforeEveryRun) {
  int restored = 0, run = 0;
  const double seconds = TimeShortest(
      3, [&] { ++restored; }, [&] { ++run; });
  EXPECT_EQ(restored, 4);
  EXPECT_EQ(run, 4);
  EXPECT_GE(seconds, 0.0);
}

TEST(TimeShortest, CountsTheOnlyRunOfNoRepeats) {
  int run = 0;
  const double seconds = TimeShortest(
      0, [] {}, [&] { ++run; });
  EXPECT_EQ(run, 1);
  EXPECT_LT(seconds, 1e6);
}

// About a minute: each environment is measured for two seconds.
TEST(EnvironmentBenchmarkSlow, MeasuresEveryEnvironmentAndItsPictures) {
  const auto result = RunEnvironmentBenchmark({.threads = 2, .repeats = 1});
  ASSERT_TRUE(result.ok()) << result.error().Text();
  const auto value_of = [&](std::string_view name) {
    for (const BenchmarkCase& entry : result->cases)
      if (entry.name == name) return entry.value;
    return -1.0;
  };
  for (const char* name :
       {"peg_transfer/rate", "cholecystectomy/rate", "cholecystectomy/memory_each", "peg_transfer/pictures",
        "cholecystectomy/pictures", "pool_of_2/rate", "pool_at_once_of_8/rate", "processes_of_8/rate"})
    EXPECT_GT(value_of(name), 0) << name;
  EXPECT_EQ(result->ratios.front().name, "pool_of_2/processes_of_2");
  EXPECT_EQ(result->ratios.size(), 4U);
}

TEST(OperationBenchmark, AsksTheOtherProgramFirst) {
  const auto result = RunOperationBenchmark({.repeats = 1, .beside = "/bin/false"});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, base::ErrorCode::kUsage);
  EXPECT_NE(result.error().Text().find("/bin/false"), std::string::npos);
}

// Minutes: the scripted surgeons play up to where each part begins, where that is not in the cache yet.
TEST(OperationBenchmarkSlow, MeasuresEveryPart) {
  const auto result = RunOperationBenchmark({.repeats = 1});
  ASSERT_TRUE(result.ok()) << result.error().Text();
  const auto value_of = [&](std::string_view name) {
    for (const BenchmarkCase& entry : result->cases)
      if (entry.name == name) return entry.value;
    return -1.0;
  };
  for (const char* name :
       {"operation/ticks_per_s", "operation/tick_p99", "operation/times_real_time",
        "operation/traction/tick_p50", "operation/fat/tick_p50", "operation/clips/tick_p50",
        "operation/bed/tick_p50", "operation/bleeding/tick_cut"})
    EXPECT_GT(value_of(name), 0) << name;
  EXPECT_EQ(value_of("operation/judged_ticks") + value_of("operation/unsettled_ticks"), 60);
  EXPECT_LT(value_of("operation/true_error_median"), 1e-3);
}

TEST(ElementaryBenchmark, ComparesEveryFunctionWithTheLibrarys) {
  const auto result = RunElementaryBenchmark({.repeats = 0});
  ASSERT_TRUE(result.ok()) << result.error().Text();
  EXPECT_EQ(result->ratios.size(), 14U);
  ASSERT_EQ(result->cases.size(), 28U);
  for (const BenchmarkCase& entry : result->cases) EXPECT_GT(entry.value, 0) << entry.name;
}

TEST(SoakBenchmark, TakesActionsInEveryEnvironment) {
  const auto result = RunSoakBenchmark({.steps = 110, .seed = 2});
  ASSERT_TRUE(result.ok()) << result.error().Text();
  ASSERT_GT(result->cases.size(), 10U) << "one of each environment, and what all come to";
  const BenchmarkCase& actions = *(result->cases.end() - 2);
  EXPECT_EQ(actions.name, "actions");
  EXPECT_GE(actions.value, 55);
  EXPECT_EQ(result->cases.back().name, "most_growth");
  EXPECT_LT(result->cases.back().value, 0.05) << "MB are lost from one turn to the next";
}

TEST(WrongAnswer, HasTheCodeOfABenchmarkThatMeansNothing) {
  EXPECT_EQ(WrongAnswer("liver_exact", "not the nearest triangle").code, base::ErrorCode::kBenchmarkWrong);
}

}  // namespace
}  // namespace trocar::bench
