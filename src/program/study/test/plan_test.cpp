// SPDX-License-Identifier: Apache-2.0
#include "trocar/study/plan.h"

#include <gtest/gtest.h>

#include <set>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::study {
namespace {

class PlanTest : public testing::Test {
 protected:
  base::Result<StudyPlan> Read(const std::string& text) {
    EXPECT_TRUE(host::WriteFile(path_, text).ok());
    return ReadPlan(path_);
  }
  static std::string Make(const std::string& more) {
    return R"({"format": "trocar-study-plan", "version": 1, "name": "n", "task": "peg_transfer", "seeds": [1, 3])" +
           more + "}";
  }
  test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "plan.json";
};

TEST_F(PlanTest, MakesARunOfEveryCombination) {
  const auto plan = Read(Make(
      R"(, "surgeons": ["expert", "novice"], "parameters": {"gravity": [5, 9.81], "head_up": [0, 0.1, 0.2]})"));
  ASSERT_TRUE(plan.ok()) << plan.error().Text();
  const std::vector<study::Run> runs = ListRuns(*plan);
  ASSERT_EQ(runs.size(), 3U * 2 * 2 * 3);
  std::set<std::string> keys;
  for (const study::Run& run : runs) keys.insert(run.key);
  EXPECT_EQ(keys.size(), runs.size());
  EXPECT_EQ(runs[0].seed, 1U);
  EXPECT_EQ(runs[1].seed, 2U) << "seeds change quickest";
}

TEST_F(PlanTest, KnowsARunByItsInputsAlone) {
  const auto one = Read(Make(R"(, "about": "a", "parameters": {"gravity": [5, 9.81]})"));
  const auto other = Read(Make(R"(, "about": "b", "parameters": {"gravity": [9.81]})"));
  ASSERT_TRUE(one.ok() && other.ok());
  EXPECT_EQ(ListRuns(*one)[3].key, ListRuns(*other)[0].key);
  EXPECT_NE(ListRuns(*one)[0].key, ListRuns(*other)[0].key);
}

TEST_F(PlanTest, KnowsUntilWhenARunGoes) {
  const auto whole = Read(Make("")), part = Read(Make(R"(, "until": "critical_view")"));
  ASSERT_TRUE(whole.ok() && part.ok());
  EXPECT_EQ(whole->until, Until::kEnd);
  EXPECT_EQ(part->until, Until::kCriticalView);
  EXPECT_NE(ListRuns(*whole)[0].key, ListRuns(*part)[0].key);
}

TEST_F(PlanTest, RefusesWhatCannotBeRun) {
  const auto code_of = [&](const std::string& text) {
    const auto plan = Read(text);
    return plan.ok() ? base::ErrorCode::kNone : plan.error().code;
  };
  EXPECT_EQ(code_of(Make(R"(, "parameters": {"colour": [1]})")), base::ErrorCode::kStudyInvalid);
  EXPECT_EQ(code_of(Make(R"(, "parameters": {"gravity": []})")), base::ErrorCode::kStudyInvalid);
  EXPECT_EQ(code_of(Make(R"(, "parameters": {"gravity": [-1]})")), base::ErrorCode::kJsonField);
  EXPECT_EQ(code_of(Make(R"(, "surgeons": [])")), base::ErrorCode::kStudyInvalid);
  EXPECT_EQ(code_of(Make(R"(, "until": "lunch")")), base::ErrorCode::kStudyInvalid);
  EXPECT_EQ(code_of(Make(R"(, "sedes": [1, 2])")), base::ErrorCode::kJsonField);
  EXPECT_EQ(code_of(Make(R"(, "patients": ["no_such_folder"])")), base::ErrorCode::kFileMissing);
  EXPECT_EQ(
      code_of(R"({"format": "trocar-course", "version": 1, "name": "n", "task": "t", "seeds": [1, 1]})"),
      base::ErrorCode::kStudyInvalid);
  EXPECT_EQ(code_of("{"), base::ErrorCode::kJsonSyntax);
}

}  // namespace
}  // namespace trocar::study
