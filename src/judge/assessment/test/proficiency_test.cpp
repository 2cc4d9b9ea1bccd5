// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/proficiency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/scene/task.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::assessment {
namespace {

AttemptResult MakeResult(double seconds, double errors, bool is_completed = true) {
  AttemptResult result;
  result.is_completed = is_completed;
  result.metrics.values = {
      {"time", "", "", seconds}, {"errors", "", "", errors}, {"path_length", "left", "", 1.5}};
  return result;
}

Threshold AtMost(const char* metric, double value, Purpose purpose) {
  return {{metric, "", ""}, Better::kLower, value, purpose, false, "a test"};
}

Proficiency MakeProficiencyOf(std::vector<Threshold> thresholds) {
  Proficiency proficiency;
  proficiency.task = "peg_transfer";
  proficiency.level = "normal";
  proficiency.source = "a test";
  proficiency.thresholds = std::move(thresholds);
  return proficiency;
}

TEST(Judge, PassesWhatMeetsEveryThresholdAndSaysByHowMuch) {
  const Proficiency proficiency =
      MakeProficiencyOf({AtMost("errors", 0, Purpose::kSafety), AtMost("time", 48, Purpose::kTime)});
  const Verdict verdict = Judge(proficiency, MakeResult(45.5, 0));
  EXPECT_TRUE(verdict.is_passed);
  EXPECT_TRUE(verdict.is_safe);
  ASSERT_EQ(verdict.metrics.size(), 2u);
  EXPECT_EQ(verdict.metrics[0].margin, 0) << "just met";
  EXPECT_TRUE(verdict.metrics[0].is_met);
  EXPECT_DOUBLE_EQ(verdict.metrics[1].margin, 2.5);
}

TEST(Judge, TellsUnsafeFromSlow) {
  const Proficiency proficiency =
      MakeProficiencyOf({AtMost("errors", 0, Purpose::kSafety), AtMost("time", 48, Purpose::kTime)});
  const Verdict slow = Judge(proficiency, MakeResult(50, 0)), unsafe = Judge(proficiency, MakeResult(40, 1));
  EXPECT_TRUE(slow.is_safe);
  EXPECT_FALSE(slow.is_passed);
  EXPECT_DOUBLE_EQ(slow.metrics[1].margin, -2);
  EXPECT_FALSE(unsafe.is_safe);
  EXPECT_FALSE(unsafe.is_passed);
}

TEST(Judge, PassesNothingThatWasNotCompleted) {
  const Proficiency proficiency = MakeProficiencyOf({AtMost("time", 48, Purpose::kTime)});
  EXPECT_FALSE(Judge(proficiency, MakeResult(10, 0, false)).is_passed);
  const auto unfinished = Judge(proficiency, MakeResult(10, 0, false)).metrics[0];
  EXPECT_FALSE(unfinished.is_met) << "quick for having stopped";
  EXPECT_TRUE(unfinished.is_open);
  const auto slow = Judge(proficiency, MakeResult(60, 0, false)).metrics[0];
  EXPECT_FALSE(slow.is_met);
  EXPECT_FALSE(slow.is_open) << "what is missed already stays missed";
  EXPECT_TRUE(Judge(MakeProficiencyOf({}), MakeResult(10, 0)).is_passed) << "completing is all that is asked";
}

TEST(Judge, FailsWhatIsUndefinedUnlessTheThresholdSaysOtherwise) {
  Threshold clip = AtMost("clip_angle", 0.3, Purpose::kSafety);
  const Verdict fails = Judge(MakeProficiencyOf({clip}), MakeResult(10, 0));
  EXPECT_FALSE(fails.is_passed);
  EXPECT_FALSE(fails.is_safe);
  EXPECT_FALSE(fails.metrics[0].value);
  clip.passes_undefined = true;
  EXPECT_TRUE(Judge(MakeProficiencyOf({clip}), MakeResult(10, 0)).is_passed);
}

TEST(Judge, LooksAtHandAndDirection) {
  Threshold left{{"path_length", "left", ""}, Better::kHigher, 1.0, Purpose::kQuality, false, "a test"};
  Threshold right = left;
  right.of.hand = "right";
  EXPECT_TRUE(Judge(MakeProficiencyOf({left}), MakeResult(10, 0)).is_passed);
  EXPECT_FALSE(Judge(MakeProficiencyOf({right}), MakeResult(10, 0)).is_passed) << "there is no such number";
  left.value = 2;
  EXPECT_FALSE(Judge(MakeProficiencyOf({left}), MakeResult(10, 0)).is_passed);
}

TEST(CalcZScore, CountsDeviationsBetterUpAndIsLimited) {
  Norm norm{{"time", "", ""}, Better::kLower, 50, 5, 45, 12};
  EXPECT_DOUBLE_EQ(CalcZScore(norm, 45), 1);
  EXPECT_DOUBLE_EQ(CalcZScore(norm, 60), -2);
  EXPECT_DOUBLE_EQ(CalcZScore(norm, 500), -kMostDeviations);
  norm.better = Better::kHigher;
  EXPECT_DOUBLE_EQ(CalcZScore(norm, 45), -1);
  norm.deviation = 0.001;  // counts as 5 % of the mean
  EXPECT_DOUBLE_EQ(CalcZScore(norm, 52.5), 1);
  norm.mean = norm.deviation = 0;
  EXPECT_DOUBLE_EQ(CalcZScore(norm, 0), 0);
  EXPECT_DOUBLE_EQ(CalcZScore(norm, -1), -kMostDeviations);
}

TEST(CalcComposite, IsTheMeanOfWhatIsDefined) {
  const std::vector<Norm> norms = {{{"time", "", ""}, Better::kLower, 50, 5, 45, 12},
                                   {{"path_length", "left", ""}, Better::kLower, 2.0, 0.5, 1.5, 12},
                                   {{"clip_angle", "", ""}, Better::kLower, 1, 1, 1, 12}};
  EXPECT_DOUBLE_EQ(*CalcComposite(norms, MakeResult(45, 0).metrics), 1.0);
  EXPECT_DOUBLE_EQ(*CalcComposite(norms, MakeResult(55, 0).metrics), 0.0);
  EXPECT_FALSE(CalcComposite({}, MakeResult(45, 0).metrics));
}

// twelve experts, 41.5 to 52.5 s: mean 47, best quartile 44.25, deviation sqrt(13)
std::vector<AttemptResult> MakeExperts() {
  std::vector<AttemptResult> experts;
  for (int i = 0; i < 12; ++i) experts.push_back(MakeResult(41.5 + i, i == 3 ? 1 : 0));
  return experts;
}

ExpertSetSettings MakeSettings() {
  ExpertSetSettings settings;
  settings.task = "peg_transfer";
  settings.level = "normal";
  settings.source = "twelve attempts of a test";
  settings.of = {AtMost("time", 0, Purpose::kTime), AtMost("errors", 0, Purpose::kSafety)};
  return settings;
}

TEST(MakeProficiency, TakesTheMeanForTimeAndTheWorstForSafety) {
  const auto made = MakeProficiency(MakeExperts(), {}, MakeSettings());
  ASSERT_TRUE(made.ok()) << made.error().Text();
  ASSERT_EQ(made->thresholds.size(), 2u);
  EXPECT_DOUBLE_EQ(made->thresholds[0].value, 47);
  EXPECT_DOUBLE_EQ(made->thresholds[1].value, 1);
  EXPECT_NE(made->thresholds[0].source.find("12 attempts"), std::string::npos);
  EXPECT_NEAR(made->norms[0].deviation, std::sqrt(13.0), 1e-12);
  EXPECT_DOUBLE_EQ(made->norms[0].best_quartile, 44.25);
  EXPECT_TRUE(made->grades.empty());
}

TEST(MakeProficiency, TakesTheBestQuartileAndSlackWhereAsked) {
  ExpertSetSettings settings = MakeSettings();
  settings.rule = LevelRule::kBestQuartile;
  settings.slack_deviations = 2;
  const auto made = MakeProficiency(MakeExperts(), {}, settings);
  ASSERT_TRUE(made.ok());
  EXPECT_NEAR(made->thresholds[0].value, 44.25 + 2 * std::sqrt(13.0), 1e-12);
  EXPECT_DOUBLE_EQ(made->thresholds[1].value, 1) << "safety has no slack";
}

TEST(MakeProficiency, TakesTheMiddleBetweenExpertsAndNovicesWhereAsked) {
  ExpertSetSettings settings = MakeSettings();
  settings.rule = LevelRule::kMidpoint;
  EXPECT_EQ(MakeProficiency(MakeExperts(), {}, settings).error().code, base::ErrorCode::kAttemptsTooFew);
  const auto made =
      MakeProficiency(MakeExperts(), std::vector<AttemptResult>(10, MakeResult(100, 5)), settings);
  ASSERT_TRUE(made.ok());
  EXPECT_DOUBLE_EQ(made->thresholds[0].value, 0.5 * (47 + 100));
  EXPECT_DOUBLE_EQ(made->thresholds[1].value, 1) << "safety asks the experts alone";
}

TEST(MakeProficiency, DrawsGradesBetweenExpertsAndNovices) {
  std::vector<AttemptResult> novices;
  for (int i = 0; i < 10; ++i) novices.push_back(MakeResult(120 + 10 * i, 3));
  const auto made = MakeProficiency(MakeExperts(), novices, MakeSettings());
  ASSERT_TRUE(made.ok());
  ASSERT_EQ(made->grades.size(), 3u);
  EXPECT_EQ(Judge(*made, MakeResult(44, 0)).grade, "expert");
  EXPECT_EQ(Judge(*made, MakeResult(55, 0)).grade, "intermediate");
  EXPECT_EQ(Judge(*made, MakeResult(150, 4)).grade, "novice");
}

TEST(MakeProficiency, AsksForWholeNumbersOfWhatIsCounted) {
  ExpertSetSettings settings = MakeSettings();
  settings.of[1].purpose = Purpose::kQuality;
  const auto made = MakeProficiency(MakeExperts(), {}, settings);
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made->thresholds[1].value, 0) << "the mean is a twelfth of an error";
}

TEST(MakeProficiency, NeedsTenCompletedAttempts) {
  auto experts = MakeExperts();
  for (int i = 0; i < 3; ++i) experts[static_cast<std::size_t>(i)].is_completed = false;
  const auto made = MakeProficiency(experts, {}, MakeSettings());
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, base::ErrorCode::kAttemptsTooFew);
  EXPECT_NE(made.error().message.find("9 of 12"), std::string::npos) << made.error().message;
}

TEST(ProficiencyFile, IsReadAsItWasWritten) {
  test::TemporaryFolder folder;
  std::vector<AttemptResult> novices(10, MakeResult(200, 3));
  auto made = MakeProficiency(MakeExperts(), novices, MakeSettings());
  ASSERT_TRUE(made.ok());
  const auto path = folder.Path() / "mine.json";
  ASSERT_TRUE(host::WriteFile(path, FormatProficiency(*made)).ok());
  const auto read = ReadProficiency(path);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->key, "mine");
  EXPECT_EQ(FormatProficiency(*read), FormatProficiency(*made));
  EXPECT_EQ(read->thresholds[0].value, made->thresholds[0].value) << "to the bit";
}

struct Wrong {
  const char *from, *to, *place;
};

TEST(ProficiencyFile, IsRefusedWithFilePathAndRemedy) {
  test::TemporaryFolder folder;
  const auto path = folder.Path() / "wrong.json";
  const std::string good =
      R"({"format": "trocar-proficiency", "version": 1, "task": "wire_run", "level": "easy",
    "source": "us", "thresholds": [{"metric": "time", "at_most": 40, "purpose": "time", "source": "us"}]})";
  ASSERT_TRUE(host::WriteFile(path, good).ok());
  ASSERT_TRUE(ReadProficiency(path).ok());
  for (const Wrong& wrong :
       {Wrong{"\"at_most\": 40", "\"at_most\": 40, \"at_least\": 4", "thresholds[0]"},
        Wrong{"\"purpose\": \"time\"", "\"purpose\": \"haste\"", "thresholds[0]"},
        Wrong{"\"purpose\": \"time\", \"source\": \"us\"", "\"purpose\": \"time\", \"source\": \"\"",
              "thresholds[0]"},
        Wrong{"\"at_most\": 40", "\"at_most\": \"forty\"", "thresholds[0].at_most"},
        Wrong{"\"metric\": \"time\",", "\"metric\": \"time\", \"hand\": \"third\",", "thresholds[0]"}}) {
    std::string text = good;
    text.replace(text.find(wrong.from), std::string(wrong.from).size(), wrong.to);
    ASSERT_TRUE(host::WriteFile(path, text).ok());
    const auto read = ReadProficiency(path);
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_NE(read.error().message.find(path.string()), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find(wrong.place), std::string::npos) << read.error().message;
  }
}

TEST(DeliveredProficiencies, AreOfTasksThatThereAreAndSayTheirSources) {
  const auto all = ListProficiencies();
  ASSERT_TRUE(all.ok()) << all.error().Text();
  EXPECT_GE(all->size(), 8u);
  const auto tasks = files::ListTasks();
  ASSERT_TRUE(tasks.ok());
  for (const Proficiency& one : *all) {
    bool is_known = one.task == "cholecystectomy";
    for (const auto& task : *tasks)
      is_known = is_known || (task.key == one.task && std::find(task.levels.begin(), task.levels.end(),
                                                                one.level) != task.levels.end());
    EXPECT_TRUE(is_known) << one.key;
    EXPECT_FALSE(one.source.empty()) << one.key;
    bool has_safety = false;
    for (const Threshold& threshold : one.thresholds)
      has_safety = has_safety || threshold.purpose == Purpose::kSafety;
    EXPECT_TRUE(has_safety) << one.key << ": fast and careless would pass";
  }
}

// Whoever trains at easy or hard is told what to reach there, too; and that nobody has measured people.
TEST(DeliveredProficiencies, CoverTheLevelsOfTasks) {
  const auto all = ListProficiencies();
  const auto tasks = files::ListTasks();
  ASSERT_TRUE(all.ok() && tasks.ok());
  for (const auto& task : *tasks) {
    for (const std::string& level : task.levels) {
      const auto found = std::find_if(all->begin(), all->end(), [&](const Proficiency& one) {
        return one.task == task.key && one.level == level;
      });
      ASSERT_NE(found, all->end()) << task.key << " " << level;
      const bool has_time =
          std::any_of(found->thresholds.begin(), found->thresholds.end(),
                      [](const Threshold& threshold) { return threshold.purpose == Purpose::kTime; });
      EXPECT_TRUE(has_time) << found->key;
      if (level == "normal") continue;  // some of those are published ones
      EXPECT_NE(found->source.find("--level " + level), std::string::npos)
          << found->key << ": made at that level";
      EXPECT_NE(found->source.find("Scripted surgeons, not people"), std::string::npos) << found->key;
    }
  }
}

}  // namespace
}  // namespace trocar::assessment
