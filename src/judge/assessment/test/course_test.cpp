// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/course.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::assessment {
namespace {

using base::ErrorCode;

const std::string kWords =
    R"("goal": "Do it.", "briefing": "Look first.", "after_pass": "Good.", "after_fail": "Again.")";

std::string MakeText(const std::string& steps) {
  return R"({"format": "trocar-course", "version": 1, "name": "Ours", "about": "A test.", "steps": [)" +
         steps + "]}";
}

std::string MakeStep(const std::string& key, const std::string& rest) {
  return R"({"key": ")" + key + R"(", "name": "Step )" + key + "\", " + kWords + ", " + rest + "}";
}

class CourseFile : public testing::Test {
 protected:
  base::Result<Course> Read(const std::string& text) {
    const auto path = folder_.Path() / "ours.json";
    EXPECT_TRUE(host::WriteFile(path, text).ok());
    return ReadCourse(path);
  }
  /// Refused with the file, the place in it, and words that help.
  void ExpectRefused(const std::string& steps, const std::string& place, const std::string& remedy) {
    const auto course = Read(MakeText(steps));
    ASSERT_FALSE(course.ok()) << steps;
    EXPECT_EQ(course.error().code, ErrorCode::kCourseInvalid) << course.error().Text();
    for (const std::string& part : {std::string("ours.json"), place, remedy})
      EXPECT_NE(course.error().message.find(part), std::string::npos)
          << part << " in " << course.error().message;
  }
  test::TemporaryFolder folder_;
};

TEST_F(CourseFile, IsReadWithWhatItLeavesOut) {
  const auto course = Read(MakeText(
      MakeStep("wire", R"("task": "wire_run")") + "," +
      MakeStep("all",
               R"("operation": "cholecystectomy", "patient": {"seed": 7, "set": {"moynihan_hump": "yes"}},
        "from": "critical_view", "until": "divided", "passes": 5, "consecutive_passes": 3, "prerequisites": ["wire"],
        "due_days": 14, "own_thresholds": [{"metric": "errors_critical", "at_most": 0, "purpose": "safety",
        "source": "us"}])")));
  ASSERT_TRUE(course.ok()) << course.error().Text();
  EXPECT_EQ(course->key, "ours");
  ASSERT_EQ(course->steps.size(), 2u);
  const Step &wire = course->steps[0], &all = course->steps[1];
  EXPECT_EQ(wire.level, "normal");
  EXPECT_EQ(wire.consecutive_passes, 2u);
  EXPECT_TRUE(wire.proficiency.thresholds.empty());
  EXPECT_FALSE(wire.seed);
  EXPECT_TRUE(all.IsOperation());
  EXPECT_EQ(all.patient.Text(), "seed 7, moynihan_hump=yes");
  EXPECT_EQ(all.from, Milestone::kCriticalView);
  EXPECT_EQ(all.until, Milestone::kDivided);
  EXPECT_EQ(all.passes, 5u);
  EXPECT_EQ(all.proficiency.thresholds.size(), 1u);
  EXPECT_EQ(all.due_days, 14);
}

TEST_F(CourseFile, IsRefusedAtItsPlaceWithARemedy) {
  ExpectRefused(MakeStep("a", R"("task": "wire_jog")"), "steps[0]", "wire_run");
  ExpectRefused(MakeStep("a", R"("level": "easy")"), "steps[0]", "a task or an operation");
  ExpectRefused(MakeStep("a", R"("task": "peg_transfer", "level": "easy")"), "steps[0]", "it has normal");
  ExpectRefused(MakeStep("a", R"("operation": "appendectomy")"), "steps[0]", "cholecystectomy");
  ExpectRefused(MakeStep("a", R"("task": "wire_run", "operation": "cholecystectomy")"), "steps[0]", "either");
  ExpectRefused(MakeStep("a", R"("operation": "cholecystectomy", "from": "free", "until": "divided")"),
                "steps[0]", "the order is");
  ExpectRefused(MakeStep("a", R"("operation": "cholecystectomy", "until": "lunch")"), "steps[0]",
                "critical_view");
  ExpectRefused(MakeStep("a", R"("operation": "cholecystectomy", "patient": {"folder": "nobody"})"),
                "steps[0].patient", "trocar anatomy generate");
  ExpectRefused(
      MakeStep("a", R"("operation": "cholecystectomy", "patient": {"seed": 1, "set": {"tail": "yes"}})"),
      "steps[0].patient", "tail");
  ExpectRefused(MakeStep("a", R"("task": "wire_run", "thresholds": "of_dreams")"), "steps[0]",
                "own_thresholds");
  ExpectRefused(MakeStep("a", R"("task": "wire_run", "thresholds": "peg_transfer-normal")"), "steps[0]",
                "of another");
  ExpectRefused(MakeStep("a", R"("task": "wire_run", "prerequisites": ["b"])") + "," +
                    MakeStep("b", R"("task": "wire_run")"),
                "steps[0].prerequisites[0]", "earlier");
  ExpectRefused(MakeStep("a", R"("task": "wire_run")") + "," + MakeStep("a", R"("task": "wire_run")"),
                "steps[1]", "keys are given once");
  ExpectRefused(MakeStep("a", R"("task": "wire_run", "passes": 1, "consecutive_passes": 2)"), "steps[0]",
                "at least consecutive_passes");
  ExpectRefused("", "ours.json", "at least one step");
}

TEST_F(CourseFile, AMisspeltFieldIsFound) {
  const auto course = Read(MakeText(MakeStep("a", R"("task": "wire_run", "due_day": 3)")));
  ASSERT_FALSE(course.ok());
  EXPECT_NE(course.error().message.find("due_day"), std::string::npos) << course.error().message;
}

TEST(DeliveredCourses, AreWholeAndSayWhatASurgeonNeeds) {
  const auto courses = ListCourses();
  ASSERT_TRUE(courses.ok()) << courses.error().Text();
  ASSERT_EQ(courses->size(), 2u);
  const auto tasks = files::ListTasks();
  const Course& basic = courses->at(0);
  EXPECT_EQ(basic.key, "basic-skills");
  for (const auto& task : *tasks) {
    EXPECT_TRUE(std::any_of(basic.steps.begin(), basic.steps.end(),
                            [&](const Step& step) { return step.task == task.key; }))
        << task.key << " is in no step";
  }
  for (const Course& course : *courses) {
    for (const Step& step : course.steps) {
      EXPECT_GT(step.briefing.size(), 150u) << step.key;
      EXPECT_GT(step.after_pass.size(), 50u) << step.key;
      EXPECT_GT(step.after_fail.size(), 50u) << step.key;
      EXPECT_FALSE(step.proficiency.thresholds.empty()) << step.key;
      EXPECT_TRUE(step.due_days) << step.key;
    }
  }
  EXPECT_EQ(basic.Find("peg-transfer")->passes, 12u) << "two in a row and ten more, as in the FLS";
}

// --- progress

Step MakeStepOf(const std::string& key, std::size_t consecutive, std::size_t passes,
                std::vector<std::string> prerequisites = {}, std::optional<int> due = std::nullopt) {
  Step step;
  step.key = key;
  step.task = key;
  step.level = "normal";
  step.consecutive_passes = consecutive;
  step.passes = passes;
  step.prerequisites = std::move(prerequisites);
  step.due_days = due;
  step.proficiency.thresholds = {{{"time", "", ""}, Better::kLower, 48, Purpose::kTime, false, "a test"}};
  return step;
}

/// Letters are attempts: small ones fail, capitals pass; the letter names the task.
std::vector<Attempt> MakeAttempts(const std::string& letters) {
  std::vector<Attempt> attempts;
  for (const char letter : letters) {
    Attempt attempt;
    const bool passes = letter >= 'A' && letter <= 'Z';
    attempt.task = std::string(1, passes ? static_cast<char>(letter - 'A' + 'a') : letter);
    attempt.level = "normal";
    attempt.result.is_completed = true;
    attempt.result.metrics.values = {{"time", "", "", passes ? 40.0 : 60.0}};
    attempts.push_back(attempt);
  }
  return attempts;
}

Course MakeCourse() {
  Course course;
  course.key = "ours";
  course.steps = {MakeStepOf("a", 2, 2, {}, 10), MakeStepOf("b", 2, 4, {"a"}, 20),
                  MakeStepOf("c", 1, 1, {}, 5)};
  return course;
}

std::string StatesOf(const CourseProgress& progress) {
  std::string states;
  for (const StepProgress& step : progress.steps) states += std::string(NameOf(step.state)) + " ";
  return states;
}

TEST(CalcProgress, OpensStepsAsThoseBeforeAreDone) {
  const Course course = MakeCourse();
  EXPECT_EQ(StatesOf(CalcProgress(course, {})), "open locked open ");
  EXPECT_EQ(StatesOf(CalcProgress(course, MakeAttempts("A"))), "open locked open ");
  EXPECT_EQ(StatesOf(CalcProgress(course, MakeAttempts("AaA"))), "open locked open ") << "not in a row";
  EXPECT_EQ(StatesOf(CalcProgress(course, MakeAttempts("AaAA"))), "done open open ");
  EXPECT_EQ(CalcProgress(course, {}).steps[1].locked_by, std::vector<std::string>{"a"});
}

TEST(CalcProgress, AsksForPassesInARowAndInAll) {
  const Course course = MakeCourse();
  EXPECT_EQ(StatesOf(CalcProgress(course, MakeAttempts("AABB"))), "done open open ");
  EXPECT_EQ(StatesOf(CalcProgress(course, MakeAttempts("AABBbBbB"))), "done done open ");
  EXPECT_EQ(StatesOf(CalcProgress(course, MakeAttempts("AABbBbBbB"))), "done open open ")
      << "four, never two in a row";
  const auto progress = CalcProgress(course, MakeAttempts("AABBbBbBC"));
  EXPECT_TRUE(progress.IsDone());
  EXPECT_EQ(progress.steps[1].attempts, 6u);
  EXPECT_EQ(progress.steps[1].passes, 4u);
  EXPECT_EQ(progress.steps[1].longest_run, 2u);
}

TEST(CalcProgress, AttemptsOfOthersStepsDoNotBreakARow) {
  EXPECT_EQ(StatesOf(CalcProgress(MakeCourse(), MakeAttempts("AcA"))), "done open open ");
}

TEST(CalcProgress, DoesNotCountAttemptsAtALockedStep) {
  const auto progress = CalcProgress(MakeCourse(), MakeAttempts("BBBBAAB"));
  EXPECT_EQ(progress.steps[1].attempts, 1u);
  EXPECT_EQ(progress.steps[1].state, StepState::kOpen);
}

TEST(CalcProgress, WhatIsDoneStaysDone) {
  EXPECT_EQ(StatesOf(CalcProgress(MakeCourse(), MakeAttempts("AAaaa"))), "done open open ");
}

TEST(CalcProgress, NextIsWhatIsDueFirst) {
  const Course course = MakeCourse();
  const CourseDates dates{ParseDay("2026-11-01"), ParseDay("2026-11-08")};
  auto progress = CalcProgress(course, {}, dates);
  ASSERT_TRUE(progress.next);
  EXPECT_EQ(progress.steps[*progress.next].key, "c");
  EXPECT_EQ(FormatDay(*progress.steps[2].due), "2026-11-06");
  EXPECT_TRUE(progress.steps[2].is_overdue);
  EXPECT_FALSE(progress.steps[0].is_overdue);
  progress = CalcProgress(course, MakeAttempts("C"), dates);
  EXPECT_EQ(progress.steps[*progress.next].key, "a");
  EXPECT_FALSE(progress.steps[2].is_overdue) << "done";
  EXPECT_EQ(*CalcProgress(course, {}).next, 0u) << "without dates the first";
}

TEST(IsAttemptAt, LooksAtNamesThenAtWhatWasDone) {
  const Course course = MakeCourse();
  Attempt attempt = MakeAttempts("A")[0];
  EXPECT_TRUE(IsAttemptAt(course, course.steps[0], attempt));
  attempt.level = "easy";
  EXPECT_FALSE(IsAttemptAt(course, course.steps[0], attempt));
  attempt.course = "ours", attempt.step = "a";
  EXPECT_TRUE(IsAttemptAt(course, course.steps[0], attempt));
  attempt.course = "theirs";
  EXPECT_FALSE(IsAttemptAt(course, course.steps[0], attempt));
  // parts of one operation are told apart
  Step part;
  part.key = "part";
  part.operation = "cholecystectomy";
  part.until = Milestone::kCriticalView;
  Attempt whole;
  whole.task = "cholecystectomy";
  EXPECT_FALSE(IsAttemptAt(course, part, whole));
  whole.until = Milestone::kCriticalView;
  EXPECT_TRUE(IsAttemptAt(course, part, whole));
  whole.patient = "seed 3";
  EXPECT_FALSE(IsAttemptAt(course, part, whole));
}

TEST(ParseDay, TakesDaysThatThereAre) {
  EXPECT_EQ(FormatDay(*ParseDay("2028-02-29")), "2028-02-29");
  for (const char* wrong :
       {"2026-02-29", "2026-13-01", "2026-1-1", "26-01-01", "2026/01/01", "", "2026-0a-01"})
    EXPECT_FALSE(ParseDay(wrong)) << wrong;
}

// --- attempts

TEST(AttemptsFile, KeepsWhatIsAppended) {
  test::TemporaryFolder folder;
  const auto path = folder.Path() / "mine.json";
  auto attempts = MakeAttempts("Ab");
  attempts[0].course = "ours", attempts[0].step = "a";
  attempts[0].score = 71.25;
  attempts[1].patient = "seed 7";
  attempts[1].from = Milestone::kDivided, attempts[1].until = Milestone::kFree;
  attempts[1].seed = 9007199254740991;
  for (const Attempt& attempt : attempts) ASSERT_TRUE(AppendAttempt(path, attempt).ok());
  const auto read = ReadAttempts(path);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(FormatAttempts(*read), FormatAttempts(attempts));
  EXPECT_EQ(read->at(1).seed, attempts[1].seed);
  EXPECT_EQ(read->at(1).until, Milestone::kFree);
}

TEST(AttemptsFile, IsRefusedAtItsPlaceAndNothingIsLost) {
  test::TemporaryFolder folder;
  const auto path = folder.Path() / "mine.json";
  const std::string text =
      R"({"format": "trocar-attempts", "version": 1, "attempts": [{"task": "a", "completed": true, "metrics": [{"metric": "time"}]}]})";
  ASSERT_TRUE(host::WriteFile(path, text).ok());
  const auto read = ReadAttempts(path);
  ASSERT_FALSE(read.ok());
  EXPECT_NE(read.error().message.find("attempts[0].metrics[0]"), std::string::npos) << read.error().message;
  EXPECT_FALSE(AppendAttempt(path, MakeAttempts("A")[0]).ok());
  EXPECT_EQ(*host::ReadFile(path), text);
}

}  // namespace
}  // namespace trocar::assessment
