// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "solver_times.h"

namespace trocar::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

Experiment MakeExample() {
  return {"fig<0>",    "Figure 0: a < b",
          "how & why", {{"Table & title", {"mesh", "a|b"}, {{"one", {1.25}}, {"two", kNotReadable}}}},
          {"a note"},  {{{"plot", "x", "y"}, {{"line", {{1, 1}, {2, 4}}}}}}};
}

// The paper's own columns, and Euler's formula where the paper slips.
TEST(ReproduceTable1, CountsThePapersMeshes) {
  ExperimentStore store;
  const auto experiment = ReproduceTable1({}, store);
  ASSERT_TRUE(experiment);
  const auto& rows = experiment->tables.at(0).rows;
  ASSERT_EQ(rows.size(), 4u);
  for (const auto& row : rows) {
    EXPECT_EQ(row[2].number, row[3].number) << "points";
    EXPECT_EQ(row[4].number, row[5].number) << "triangles";
    EXPECT_EQ(row[6].number + 1, row[7].number) << "edges";
    EXPECT_EQ(row[3].number + row[5].number - row[7].number, 1) << "Euler characteristic of a disc";
  }
}

TEST(ExperimentPages, SayEachFigureOnceAndEscapeText) {
  const Experiment example = MakeExample();
  const std::string page = FormatExperimentPage(example, "a machine");
  for (const char* text : {"Figure 0: a &lt; b", "how &amp; why", "a|b", "1.25", "not readable", "a note",
                           "<svg", "a machine", "fig&lt;0&gt;"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  EXPECT_THAT(page, Not(HasSubstr("http"))) << "nothing from elsewhere";
  const std::string index = FormatExperimentIndex(std::span(&example, 1), "a machine");
  EXPECT_THAT(index, HasSubstr("href=\"fig&lt;0&gt;.html\""));
  EXPECT_THAT(FormatExperimentsMarkdown(std::span(&example, 1), "m"),
              HasSubstr("| mesh | a\\|b |\n|---|---|\n"));
  EXPECT_THAT(FormatExperimentText(example), HasSubstr("two   not readable"));
  const std::string svg = FormatSvgFile(example.plots[0]);
  EXPECT_THAT(svg, HasSubstr("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox="));
  EXPECT_EQ(svg.find("<style>"), svg.find(">\n") + 2) << "inside the picture";
}

TEST(ExperimentPages, JsonHasNumbersWhereThereAreNumbers) {
  const Experiment example = MakeExample();
  const auto json = nlohmann::json::parse(FormatExperimentsJson(std::span(&example, 1), "m"));
  const auto& rows = json.at("experiments").at(0).at("tables").at(0).at("rows");
  EXPECT_EQ(rows.at(0).at("a|b"), 1.25);
  EXPECT_EQ(rows.at(1).at("a|b"), kNotReadable);
}

TEST(ReplaceGeneratedPart, LeavesTheRestAloneAndRefusesWhatIsNotSound) {
  const std::string begin(kGeneratedBegin), end(kGeneratedEnd);
  const auto replaced = ReplaceGeneratedPart("before\n" + begin + "\nold\n" + end + "\nafter\n", "new\n");
  ASSERT_TRUE(replaced);
  EXPECT_EQ(*replaced, "before\n" + begin + "\n\nnew\n" + end + "\nafter\n");
  EXPECT_EQ(*ReplaceGeneratedPart(*replaced, "new\n"), *replaced) << "twice is once";
  for (const std::string& bad :
       {std::string(), begin, end, end + begin, begin + begin + end, begin + end + end}) {
    const auto result = ReplaceGeneratedPart(bad, "new");
    ASSERT_FALSE(result) << bad;
    EXPECT_EQ(result.error().code, base::ErrorCode::kUsage);
  }
}

TEST(AddGpuRows, TakesTheTimesOfTheGpuAndNoneOfTheHostExecutor) {
  tissue_cuda::GpuBenchmarkResult measured;
  measured.cases = {{"iteration/shared-coalesced_single_256", 3.5, "us"},
                    {"iteration/shared-coalesced_double_256", 7.0, "us"},
                    {"iteration/tiled_single_12544", 2.0, "us"}};
  for (const bool has_gpu : {true, false}) {
    measured.has_gpu = has_gpu;
    SolverTimes times;
    times.sides = {16, 112};
    AddGpuRows(&measured, "a GPU", times);
    ASSERT_EQ(times.rows.size(), 5u) << "the paper's four layouts and ours";
    EXPECT_EQ(times.rows[3].solver, "GPU, shared-coalesced");
    EXPECT_EQ(times.rows[3].note, "a GPU");
    if (has_gpu) {
      EXPECT_DOUBLE_EQ(times.rows[3].seconds[0], 3.5e-6);
      EXPECT_DOUBLE_EQ(times.rows[4].seconds[1], 2e-6);
    } else {
      EXPECT_TRUE(std::isnan(times.rows[3].seconds[0]));
    }
    EXPECT_TRUE(std::isnan(times.rows[3].seconds[1])) << "not measured";
    EXPECT_TRUE(std::isnan(times.rows[0].seconds[0]));
  }
}

}  // namespace
}  // namespace trocar::bench
