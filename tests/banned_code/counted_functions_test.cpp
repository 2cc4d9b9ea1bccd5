// SPDX-License-Identifier: Apache-2.0
// No call of the C library's elementary functions, whose last bit no standard fixes, may decide what a tick computes.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "counted_functions.h"
#include "golden_play.h"
#include "trocar_test/temporary_folder.h"

extern "C" double CallExp(double x);  // calls_exp.cpp

namespace trocar::banned_code {
namespace {

using bits::Golden;
using bits::GoldenPlay;

std::vector<Golden> GoldensOf(const std::string& lane) {
  const auto all = bits::ReadGoldens(TROCAR_SOURCE_DIR);
  std::vector<Golden> chosen;
  if (!all.ok()) return chosen;
  for (const Golden& golden : *all)
    if (golden.lane == lane) chosen.push_back(golden);
  return chosen;
}

/// Makes it and plays so many ticks, or to its end.
void ExpectNoCalls(const Golden& golden, std::uint64_t most_ticks) {
  const test::TemporaryFolder scratch;
  CallTable making, deciding, stepping;
  const auto make = [&] {
    const Counting counting(making);
    return GoldenPlay::Make(golden, TROCAR_SOURCE_DIR, scratch.Path(), 2);
  };
  auto play = make();
  ASSERT_TRUE(play.ok()) << play.error().Text();
  for (std::uint64_t tick = 0; tick < most_ticks && !play->IsOver(); ++tick) {
    scene::Input input;
    {
      const Counting counting(deciding);
      input = play->DecideInput();
    }
    const Counting counting(stepping);
    play->Step(input);
  }
  EXPECT_EQ(stepping.Calls(), 0U) << golden.name << ", in its ticks:\n" << stepping.Text();
  EXPECT_EQ(deciding.Calls(), 0U) << golden.name << ", where surgeon or script decide:\n" << deciding.Text();
  EXPECT_EQ(making.Calls(), 0U) << golden.name << ", while it is made:\n" << making.Text();
}

std::string NameOf(const testing::TestParamInfo<Golden>& info) {
  std::string name = info.param.name;
  for (char& letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  return name;
}

// controls: calls made on purpose
TEST(CountedFunctions, CountsTheProgramsOwnCalls) {
  volatile double x = 0.5;
  CallTable table;
  {
    const Counting counting(table);
    volatile double y = std::exp(x) + std::pow(x, 1.7);
    (void)y;
  }
  EXPECT_EQ(table.Calls(), 2U);
  EXPECT_NE(table.Text().find("1 times exp, from"), std::string::npos) << table.Text();
  volatile double y = std::exp(x);  // nobody counts any more
  EXPECT_DOUBLE_EQ(y, 1.6487212707001282);
  EXPECT_EQ(table.Calls(), 2U);
}

TEST(CountedFunctions, CountsCallsOfSharedLibraries) {
  CallTable table;
  {
    const Counting counting(table);
    EXPECT_DOUBLE_EQ(CallExp(0.5), 1.6487212707001282);
  }
  EXPECT_EQ(table.Calls(), 1U);
  EXPECT_NE(table.Text().find("CallExp"), std::string::npos) << table.Text();
}

class EngineCallsNoElementaryFunction : public testing::TestWithParam<Golden> {};

TEST_P(EngineCallsNoElementaryFunction, InTheFirstSecond) {
  constexpr std::uint64_t kTicks = 120;
  ExpectNoCalls(GetParam(), kTicks);
}
INSTANTIATE_TEST_SUITE_P(Goldens, EngineCallsNoElementaryFunction, testing::ValuesIn(GoldensOf("golden")),
                         NameOf);

class EngineCallsNoElementaryFunctionSlow : public testing::TestWithParam<Golden> {};

TEST_P(EngineCallsNoElementaryFunctionSlow, ToTheEnd) {
  ExpectNoCalls(GetParam(), std::numeric_limits<std::uint64_t>::max());
}
INSTANTIATE_TEST_SUITE_P(Goldens, EngineCallsNoElementaryFunctionSlow, testing::ValuesIn(GoldensOf("golden")),
                         NameOf);

class EngineCallsNoElementaryFunctionWhole : public testing::TestWithParam<Golden> {};

TEST_P(EngineCallsNoElementaryFunctionWhole, ToTheEnd) {
  ExpectNoCalls(GetParam(), std::numeric_limits<std::uint64_t>::max());
}
INSTANTIATE_TEST_SUITE_P(Operations, EngineCallsNoElementaryFunctionWhole,
                         testing::ValuesIn(GoldensOf("whole")), NameOf);

}  // namespace
}  // namespace trocar::banned_code
