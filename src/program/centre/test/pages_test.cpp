// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "recorded_attempt.h"
#include "store_test.h"
#include "trocar/assessment/certificate.h"
#include "trocar/centre/best_results.h"
#include "trocar/centre/course_page.h"
#include "trocar/centre/exam_page.h"
#include "trocar/centre/group_page.h"
#include "trocar/centre/history_page.h"
#include "trocar/centre/result_page.h"
#include "trocar/host/safe_file.h"
#include "trocar/store/courses.h"

namespace trocar::centre {
namespace {

using store::Kind;
using store::KindName;
using store::Role;
using testing::HasSubstr;

/// The same pages over both databases.
class Pages : public store::StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    access_.place = place_;
  }
  /// An attempt at a task, so many days into November.
  store::Attempt MakeOne(int day, const std::string& trainee, double seconds, std::optional<bool> is_passed) {
    store::Attempt attempt = store::MakeAttempt(day, trainee);
    char started[40];
    std::snprintf(started, sizeof started, "2026-11-%02dT10:00:00+01:00", day);
    attempt.started = started;
    attempt.recording_id = base::HashText(static_cast<std::uint64_t>(day) * 1000 + trainee.back());
    attempt.level = "normal";
    attempt.seconds = seconds;
    attempt.is_passed = is_passed;
    attempt.score = 100 - day;
    return attempt;
  }
  void Keep(const store::Attempt& attempt) {
    const auto added = store::AddAttempt(Open(), attempt);
    ASSERT_TRUE(added.ok()) << added.error().Text();
  }

  Access access_;
};
INSTANTIATE_OVER_DATABASES(Pages);

TEST_P(Pages, HistoryListsTheNewestFirstByPages) {
  const std::string who = Add(Role::kTrainee);
  for (int day = 1; day <= 25; ++day) Keep(MakeOne(day, who, 100.0 / day, day > 3));
  access_.person = who;
  const auto first = LoadHistory(access_, {who, "", ""});
  ASSERT_TRUE(first.ok()) << first.error().Text();
  ASSERT_EQ(first->rows.size(), 20u);
  EXPECT_THAT(first->rows[0].when, HasSubstr("25 November 2026"));
  EXPECT_EQ(first->rows[0].outcome, "passed");
  EXPECT_EQ(first->rows[0].tone, Tone::kGood);
  EXPECT_TRUE(first->rows[0].recording.empty()) << "there is no such file";
  ASSERT_FALSE(first->next.empty());
  const auto rest = LoadHistory(access_, {who, "", first->next});
  ASSERT_TRUE(rest.ok());
  ASSERT_EQ(rest->rows.size(), 5u);
  EXPECT_EQ(rest->rows.back().outcome, "not passed");
  EXPECT_TRUE(rest->next.empty());
}

TEST_P(Pages, BestResultsAreOneOwnOfEachTaskAndLevel) {
  const std::string who = Add(Role::kTrainee), other = Add(Role::kTrainee);
  Keep(MakeOne(1, who, 90, true));  // score 99
  Keep(MakeOne(2, who, 60, true));
  Keep(MakeOne(3, other, 30, true));
  store::Attempt given_up = MakeOne(4, who, 5, {});
  given_up.is_completed = false;
  Keep(given_up);
  given_up = MakeOne(5, who, 5, {});
  given_up.task = "cholecystectomy", given_up.level = "hard", given_up.is_completed = false;
  Keep(given_up);
  access_.person = who;
  const auto best = LoadBestResults(access_);
  ASSERT_TRUE(best.ok()) << best.error().Text();
  const BestResult& rings = best->at({"peg_transfer", "normal"});
  EXPECT_EQ(rings.attempts, 3u);
  EXPECT_EQ(rings.completed, 2u);
  EXPECT_EQ(rings.score, 99);
  EXPECT_EQ(rings.seconds, 60) << "what was given up counts for no time";
  EXPECT_EQ(DescribeBest(*best, "peg_transfer", "normal"), "Best 99.0 %, 1:00; 3 attempts");
  EXPECT_EQ(DescribeBest(*best, "cholecystectomy", "hard"), "Not completed in 1 attempt");
  EXPECT_EQ(DescribeBest(*best, "wire_run", "easy"), "Not tried yet");
}

TEST_P(Pages, HistoryOfATaskShowsHowItIsLearnt) {
  const std::string who = Add(Role::kTrainee);
  for (int day = 1; day <= 12; ++day) Keep(MakeOne(day, who, 60 + 120.0 / day, day > 3));
  access_.person = who;
  const auto page = LoadHistory(access_, {who, "peg_transfer", ""});
  ASSERT_TRUE(page.ok()) << page.error().Text();
  EXPECT_EQ(page->drawings.size(), 2u) << "learning curve and CUSUM";
  const std::string all = testing::PrintToString(page->findings);
  EXPECT_THAT(all, HasSubstr("practice leads towards"));
  EXPECT_THAT(all, HasSubstr("getting faster"));
  EXPECT_THAT(all, HasSubstr("CUSUM"));
}

TEST_P(Pages, WhatIsNotCompletedIsNotGreen) {
  const std::string who = Add(Role::kTrainee);
  store::Attempt attempt = MakeOne(1, who, 60, std::nullopt);
  attempt.is_completed = false;
  Keep(attempt);
  access_.person = who;
  const auto page = LoadHistory(access_, {who, "", ""});
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(page->rows[0].outcome, "not completed");
  EXPECT_EQ(page->rows[0].tone, Tone::kCaution);
  EXPECT_EQ(page->rows[0].score, "") << "what was not completed has no score";
}

// Each page on which an attempt shows; a new one joins this list.
TEST_P(Pages, EachSaysWhatIsNotVerifiedAndDoesNotCountIt) {
  const std::string who = Add(Role::kTrainee), instructor = Add(Role::kInstructor);
  ASSERT_TRUE(store::AddGroup(Open(), store::kOwner, "Ward 3").ok());
  for (const std::string& member : {instructor, who})
    ASSERT_TRUE(store::JoinGroup(Open(), store::kOwner, "Ward 3", member).ok());
  const auto whole = assessment::FindCourse("basic-skills");
  ASSERT_TRUE(whole.ok());
  const auto step = assessment::FindStep(*whole, whole->steps.front().key);  // the others are locked
  ASSERT_TRUE(step.ok());
  const auto keep = [&](int day, store::VerificationMark mark) {
    store::Attempt attempt = MakeOne(day, who, 30, true);
    attempt.task = step->task, attempt.level = step->level;
    attempt.metrics.clear();
    for (const assessment::Threshold& threshold : step->proficiency.thresholds)
      attempt.metrics.push_back(
          {threshold.of.metric, threshold.of.hand, threshold.of.phase, threshold.value, ""});
    attempt.mark = std::move(mark);
    Keep(attempt);
  };
  struct Shown {
    std::string page, text;
    bool counts;
  };
  const auto show = [&]() -> std::vector<Shown> {
    Access own = access_, teacher = access_;
    own.person = who, teacher.person = instructor;
    const auto history = LoadHistory(own, {who, "", ""});
    const auto of_task = LoadHistory(own, {who, step->task, ""});
    const auto best = LoadBestResults(own);
    const auto course = LoadCourse(own, "basic-skills");
    const auto group = LoadGroup(teacher, "Ward 3");
    EXPECT_TRUE(history.ok() && of_task.ok() && best.ok() && course.ok() && group.ok());
    JudgedAttempt judged;
    judged.attempt = history->rows[0].attempt;
    judged.report.facts.task_key = "x", judged.report.is_operation = true;
    const ResultPage result = MakeResultPage(judged, nullptr);
    const auto& cell = group->members.at(0).cells.at(0);
    const std::string& tried = course->page.steps.front().progress;
    return {{"history", history->rows[0].outcome,
             history->rows[0].tone != Tone::kCaution && history->rows[0].tone != Tone::kBad},
            {"history of a task", testing::PrintToString(of_task->findings), !of_task->drawings.empty()},
            {"best", DescribeBest(*best, step->task, step->level),
             best->at({step->task, step->level}).completed > 0},
            {"course", course->page.note, tried != "not tried yet"},
            {"group", cell.text, cell.is_passed},
            {"result", result.verdict, result.tone == Tone::kPlain}};
  };
  keep(1, {});
  for (const Shown& shown : show()) {
    EXPECT_THAT(shown.text, HasSubstr("not verified")) << shown.page;
    EXPECT_FALSE(shown.counts) << shown.page;
  }
  // the control: the same attempt, verified
  ASSERT_TRUE(Open().GetDatabase().Run("DELETE FROM attempt").ok());
  keep(2, {store::Verification::kVerified, store::WhyUnverified::kNone, "", {}, ""});
  for (const Shown& shown : show()) {
    EXPECT_THAT(shown.text, testing::Not(HasSubstr("not verified"))) << shown.page;
    EXPECT_TRUE(shown.counts) << shown.page;
  }
}

TEST_P(Pages, TraineesSeeNobodyElsesHistory) {
  const std::string one = Add(Role::kTrainee), other = Add(Role::kTrainee);
  Keep(MakeOne(1, one, 60, true));
  access_.person = other;
  const auto page = LoadHistory(access_, {one, "", ""});
  EXPECT_TRUE(!page.ok() || page->rows.empty());
  access_.person = one;
  const auto own = LoadHistory(access_, {one, "", ""});
  ASSERT_TRUE(own.ok());
  EXPECT_EQ(own->rows.size(), 1u) << "the control";
}

TEST_P(Pages, NobodysLearningIsDrawnOfSeveralPeople) {
  const std::string one = Add(Role::kTrainee), other = Add(Role::kTrainee);
  for (int day = 1; day <= 6; ++day) Keep(MakeOne(day, one, 60 + day, true));
  const auto alone = LoadHistory(access_, {"", "peg_transfer", ""});
  ASSERT_TRUE(alone.ok());
  EXPECT_EQ(alone->drawings.size(), 2u);
  for (int day = 7; day <= 12; ++day) Keep(MakeOne(day, other, 60 + day, true));
  const auto mixed = LoadHistory(access_, {"", "peg_transfer", ""});
  ASSERT_TRUE(mixed.ok());
  EXPECT_EQ(mixed->rows.size(), 12u);
  EXPECT_TRUE(mixed->drawings.empty());
}

TEST_P(Pages, GroupShowsMembersAndWhatTheyCameTo) {
  const std::string instructor = Add(Role::kInstructor), one = Add(Role::kTrainee), two = Add(Role::kTrainee);
  ASSERT_TRUE(store::AddGroup(Open(), store::kOwner, "Ward 3").ok());
  for (const std::string& member : {instructor, one, two})
    ASSERT_TRUE(store::JoinGroup(Open(), store::kOwner, "Ward 3", member).ok());
  Keep(MakeOne(1, one, 90, false));
  Keep(MakeOne(2, one, 60, true));
  access_.person = instructor;
  const auto page = LoadGroup(access_, "");
  ASSERT_TRUE(page.ok()) << page.error().Text();
  EXPECT_EQ(page->group, "Ward 3");
  ASSERT_EQ(page->tasks.size(), 1u);
  ASSERT_EQ(page->members.size(), 2u) << "the instructor is no member that learns";
  for (const GroupPage::Member& member : page->members) {
    const GroupPage::Cell& cell = member.cells[0];
    EXPECT_EQ(cell.attempts, member.pseudonym == one ? 2u : 0u);
    EXPECT_EQ(cell.is_passed, member.pseudonym == one);
    if (member.pseudonym == one) {
      EXPECT_THAT(cell.text, HasSubstr("last 98.0 %, best 99.0 %"));
    }
  }
  access_.person = one;
  const auto refused = LoadGroup(access_, "");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, base::ErrorCode::kStoreRefused);
}

// The issue: an instructor had to type commands.
TEST_P(Pages, InstructorsMakeGroupsMembersAndAssignmentsHere) {
  const std::string instructor = Add(Role::kInstructor), who = Add(Role::kTrainee);
  ASSERT_TRUE(MakeGroup(access_, "Ward 3").ok());
  EXPECT_FALSE(MakeGroup(access_, "Ward 3").ok()) << "there is one";
  ASSERT_TRUE(JoinGroup(access_, "Ward 3", who).ok());
  ASSERT_TRUE(JoinGroup(access_, "Ward 3", instructor).ok());
  ASSERT_TRUE(JoinGroup(access_, "Ward 3", "Anna Berg").ok()) << "a new name is a new trainee";
  EXPECT_FALSE(JoinGroup(access_, "Ward 3", "").ok());
  Access teacher = access_;
  teacher.person = instructor;
  const auto group = LoadGroup(teacher, "Ward 3");
  ASSERT_TRUE(group.ok()) << group.error().Text();
  EXPECT_EQ(group->members.size(), 2u);
  EXPECT_FALSE(group->courses.empty());
  // a course, with a day; once more with another
  EXPECT_FALSE(AssignCourse(teacher, "Ward 3", "basic-skills", "tomorrow").ok());
  for (const char* due : {"2026-12-24", "2026-12-31", ""}) {
    const auto assigned = AssignCourse(teacher, "Ward 3", "basic-skills", due);
    EXPECT_TRUE(assigned.ok()) << due << ": " << assigned.error().Text();
  }
  const auto viewer = store::FindViewer(Open(), who);
  ASSERT_TRUE(viewer.ok());
  const auto assignments = store::ListAssignments(Open(), *viewer, who);
  ASSERT_TRUE(assignments.ok());
  ASSERT_EQ(assignments->size(), 1u);
  EXPECT_EQ(assignments->front().course, "basic-skills");
  EXPECT_FALSE(assignments->front().due_ms.has_value());
  ASSERT_TRUE(LeaveGroup(access_, "Ward 3", who).ok());
  EXPECT_EQ(LoadGroup(teacher, "Ward 3")->members.size(), 1u);
  // a trainee changes nothing
  Access trainee = access_;
  trainee.person = who;
  EXPECT_FALSE(MakeGroup(trainee, "Mine").ok());
  EXPECT_FALSE(AssignCourse(trainee, "Ward 3", "basic-skills", "").ok());
}

TEST_P(Pages, HomeKnowsTheNextStepAndTheLastResult) {
  const std::string who = Add(Role::kTrainee);
  access_.person = who;
  auto home = LoadHomeResults(access_);
  ASSERT_TRUE(home.ok()) << home.error().Text();
  ASSERT_TRUE(home->leads.next.has_value());
  EXPECT_FALSE(home->leads.last.has_value());
  Keep(MakeOne(1, who, 90, true));
  Keep(MakeOne(2, who, 60, false));
  home = LoadHomeResults(access_);
  ASSERT_TRUE(home->leads.last.has_value());
  EXPECT_THAT(home->leads.last->outcome, HasSubstr("not passed"));
  EXPECT_EQ(home->leads.last->task, "peg_transfer");
  access_.person.clear();
  home = LoadHomeResults(access_);
  EXPECT_FALSE(home->leads.last.has_value() || home->leads.next.has_value())
      << "everybody's last is nobody's";
}

TEST_P(Pages, CourseMapOpensStepsAsTheyAreDone) {
  const std::string who = Add(Role::kTrainee);
  access_.person = who;
  const auto before = LoadCourse(access_, "basic-skills");
  ASSERT_TRUE(before.ok()) << before.error().Text();
  EXPECT_FALSE(before->store_failure.has_value());
  ASSERT_GE(before->page.steps.size(), 5u);
  const CoursePage::Step& first = before->page.steps[0];
  EXPECT_EQ(first.state, assessment::StepState::kOpen);
  EXPECT_EQ(before->page.next, first.key);
  EXPECT_EQ(before->page.steps[1].state, assessment::StepState::kLocked);
  EXPECT_EQ(before->page.steps[1].locked_by, first.name);

  // passes by every threshold, as often as the step asks for
  const auto step = assessment::FindStep(*assessment::FindCourse("basic-skills"), first.key);
  ASSERT_TRUE(step.ok());
  for (int day = 1; day <= static_cast<int>(step->passes); ++day) {
    store::Attempt attempt = MakeOne(day, who, 30, true);
    attempt.task = step->task, attempt.level = step->level;
    attempt.metrics.clear();
    for (const assessment::Threshold& threshold : step->proficiency.thresholds)
      attempt.metrics.push_back(
          {threshold.of.metric, threshold.of.hand, threshold.of.phase, threshold.value, ""});
    Keep(attempt);
  }
  const auto after = LoadCourse(access_, "basic-skills");
  ASSERT_TRUE(after.ok());
  EXPECT_EQ(after->page.steps[0].state, assessment::StepState::kDone);
  EXPECT_EQ(after->page.steps[1].state, assessment::StepState::kOpen);
}

TEST_P(Pages, CourseMapIsThereWhileTheStoreIsAway) {
  access_.place.url = GetParam() == store::Kind::kPostgres ? "postgresql:///nothing?host=/nowhere"
                                                           : (folder_.Path() / "away.files" / "x").string();
  if (GetParam() == store::Kind::kSqlite) {
    ASSERT_TRUE(host::WriteFile(folder_.Path() / "away.files", "a file where the folder should be").ok());
  }
  const auto loaded = LoadCourse(access_, "basic-skills");
  ASSERT_TRUE(loaded.ok()) << loaded.error().Text();
  EXPECT_TRUE(loaded->store_failure.has_value());
  EXPECT_EQ(loaded->page.steps[0].state, assessment::StepState::kOpen);
}

TEST_P(Pages, RemarksAndRatingsAreKept) {
  const std::string instructor = Add(Role::kInstructor), who = Add(Role::kTrainee);
  ASSERT_TRUE(store::AddGroup(Open(), store::kOwner, "Ward 3").ok());
  for (const std::string& member : {instructor, who})
    ASSERT_TRUE(store::JoinGroup(Open(), store::kOwner, "Ward 3", member).ok());
  const store::Attempt attempt = MakeOne(1, who, 90, false);
  Keep(attempt);
  access_.person = instructor;
  auto review = LoadReview(access_, attempt);
  ASSERT_TRUE(review.ok()) << review.error().Text();
  ASSERT_NE(review->attempt, 0);
  EXPECT_TRUE(review->may_review);
  ASSERT_EQ(review->forms.size(), 2u);
  ASSERT_TRUE(KeepRemark(access_, *review, 12, "Look at the left hand").ok());
  review->forms[0].items[0].points = 4;
  ASSERT_TRUE(KeepRating(access_, *review, review->forms[0]).ok());
  const auto again = LoadReview(access_, attempt);
  ASSERT_TRUE(again.ok());
  ASSERT_EQ(again->remarks.size(), 1u);
  EXPECT_EQ(again->remarks[0].text, "Look at the left hand");
  EXPECT_EQ(again->remarks[0].clock, "0:12");
  EXPECT_EQ(again->forms[0].items[0].points, 4);
  access_.person = who;
  EXPECT_FALSE(LoadReview(access_, attempt)->may_review);
}

TEST_P(Pages, PeopleAreFoundByNameOrPseudonym) {
  const auto made = FindPseudonym(access_, "Anna Berg");
  ASSERT_TRUE(made.ok()) << made.error().Text();
  EXPECT_THAT(*made, testing::StartsWith("T-"));
  EXPECT_EQ(NameOf(access_, *made), "Anna Berg");
  EXPECT_EQ(*FindPseudonym(access_, "Anna Berg"), *made) << "the same person again";
  EXPECT_EQ(*FindPseudonym(access_, *made), *made);
  EXPECT_EQ(*FindPseudonym(access_, ""), "");
  const auto unknown = FindPseudonym(access_, "T-QQQQQQ");
  ASSERT_FALSE(unknown.ok()) << "a pseudonym is not taken for a name";
  EXPECT_EQ(unknown.error().code, base::ErrorCode::kStoreUnknown);
  EXPECT_TRUE(store::FilesWith(place_.folder, "Anna Berg") ==
              std::vector<std::string>{place_.NamesFile().string()})
      << "the name is in the names' file alone";
}

// results

class Result : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const auto task = test::DescribeTask("instrument_navigation", "normal", 3);
    test::RecordAttempt(folder_->Path() / "whole.trocar", task, {"expert", 3, test::kUntilOver, {}});
    test::RecordAttempt(folder_->Path() / "part.trocar", task, {"novice", 3, 600, {}});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static JudgedAttempt JudgeFile(const char* name, const JudgeSettings& settings = {}) {
    auto judged = JudgeRecording(folder_->Path() / name, settings);
    EXPECT_TRUE(judged.ok()) << (judged.ok() ? "" : judged.error().Text());
    return judged.ok() ? std::move(*judged) : JudgedAttempt{};
  }
  static inline test::TemporaryFolder* folder_ = nullptr;
};

TEST_F(Result, SaysPassedOrNotInWordsAndIsGreenOnlyWherePassed) {
  const JudgedAttempt whole = JudgeFile("whole.trocar");
  EXPECT_TRUE(whole.attempt.is_completed);
  const ResultPage page = MakeResultPage(whole, nullptr);
  EXPECT_EQ(page.tone == Tone::kGood, page.verdict == "Passed");
  EXPECT_THAT(page.outcome, HasSubstr("completed"));
  EXPECT_EQ(page.drawings.size() >= 3, true);
  EXPECT_FALSE(page.metrics.empty());
  const ResultPage part = MakeResultPage(JudgeFile("part.trocar"), nullptr);
  EXPECT_EQ(part.verdict, "Not completed");
  EXPECT_EQ(part.tone, Tone::kCaution);
}

// The issue: "Time, met" with 1 of 12 goals done, two different times, no score and no reason.
TEST_F(Result, OfAnUnfinishedAttemptMeetsNothingAndHasOneTimeAndAScoreWithItsReason) {
  const JudgedAttempt judged = JudgeFile("part.trocar");
  ASSERT_FALSE(judged.attempt.is_completed);
  const ResultPage page = MakeResultPage(judged, nullptr);
  ASSERT_FALSE(page.thresholds.empty());
  for (const ResultPage::ThresholdRow& row : page.thresholds) {
    EXPECT_FALSE(row.is_met) << row.name;
    EXPECT_NE(row.is_open, row.value == "not measured") << row.name;
  }
  const auto tile = [&](const char* label) -> ResultPage::Tile {
    for (const ResultPage::Tile& one : page.tiles) {
      if (one.label == label) return one;
    }
    return {};
  };
  ASSERT_TRUE(judged.report.task_seconds.has_value());
  EXPECT_EQ(tile("Time").value, report::FormatClock(*judged.report.task_seconds));
  EXPECT_THAT(page.outcome, HasSubstr(report::FormatDuration(*judged.report.task_seconds)));
  EXPECT_THAT(tile("Score").note, HasSubstr("not finished"));
  EXPECT_THAT(tile("Score").note, HasSubstr("goals"));
  EXPECT_FALSE(page.first.empty()) << "there is something to do better: to finish";
  const ResultPage whole = MakeResultPage(JudgeFile("whole.trocar"), nullptr);
  EXPECT_TRUE(std::any_of(whole.thresholds.begin(), whole.thresholds.end(), [](const auto& row) {
    return row.is_met;
  })) << "the control: a completed one meets what it meets";
}

TEST_F(Result, OfACourseStepIsJudgedByIt) {
  JudgeSettings settings;
  settings.step = {"basic-skills", "instruments"};
  settings.person = "T-CCCCCC";
  const JudgedAttempt judged = JudgeFile("whole.trocar", settings);
  ASSERT_TRUE(judged.verdict.has_value());
  EXPECT_EQ(judged.attempt.is_passed, judged.verdict->is_passed);
  EXPECT_FALSE(judged.debriefing.empty());
  EXPECT_EQ(FindStepName(judged.attempt), settings.step) << "the store remembers for what it was made";
}

TEST_F(Result, GivesUpWhenItIsTold) {
  JudgeSettings settings;
  settings.progress = [](double) { return false; };
  const auto judged = JudgeRecording(folder_->Path() / "whole.trocar", settings);
  ASSERT_FALSE(judged.ok());
  EXPECT_EQ(judged.error().code, base::ErrorCode::kCancelled);
}

TEST_F(Result, IsSavedByTheFilesEnding) {
  const JudgedAttempt judged = JudgeFile("part.trocar");
  for (const auto& [name, begins] : {std::pair{"r.html", "<!DOCTYPE"}, std::pair{"r.pdf", "%PDF"}}) {
    ASSERT_TRUE(SaveReport(judged.report, folder_->Path() / name).ok());
    EXPECT_THAT(*host::ReadFile(folder_->Path() / name), testing::StartsWith(begins));
  }
  const auto refused = SaveReport(judged.report, folder_->Path() / "r.doc");
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, base::ErrorCode::kUsage);
}

// exams

TEST(Preparation, IsDescribedForWhoWaits) {
  assessment::PreparationProgress now;
  now.share = 0.439;
  EXPECT_EQ(DescribePreparation(now), "43 %") << "no pace is known yet";
  now.seconds_left = 61;
  EXPECT_EQ(DescribePreparation(now), "43 %, about 2 min left");
  now.seconds_left = 59;
  EXPECT_EQ(DescribePreparation(now), "43 %, less than a minute left");
  now.seconds_left.reset();
  now.is_late = true;
  EXPECT_EQ(DescribePreparation(now), "43 %, and it takes longer than usual");
}

TEST(Exam, IsSealedAndKeysAreMadeWithoutAShell) {
  const test::TemporaryFolder folder;
  const auto choices = ListExamChoices();
  ASSERT_TRUE(choices.ok());
  EXPECT_GT(choices->size(), 9u);
  const auto file = folder.Path() / "finals.json";
  const auto page = SealExamFile("Finals", "peg_transfer", "normal", file);
  ASSERT_TRUE(page.ok()) << page.error().Text();
  EXPECT_EQ(page->name, "Finals");
  EXPECT_FALSE(page->thresholds.empty()) << "the delivered thresholds of task and level pass";
  EXPECT_TRUE(std::filesystem::exists(folder.Path() / "finals.published.json"));
  EXPECT_FALSE(SealExamFile("Finals", "peg_transfer", "normal", file).ok()) << "a seal is not replaced";
  EXPECT_TRUE(SealExamFile("Whole", "cholecystectomy", "", folder.Path() / "whole.json").ok());
  ASSERT_TRUE(MakeCentreKeys(folder.Path() / "centre.key", "seven green herons").ok());
  EXPECT_TRUE(*assessment::IsKeyEncrypted(folder.Path() / "centre.key"));
  EXPECT_TRUE(assessment::ReadPublicKey(folder.Path() / "centre.pub").ok());
  EXPECT_FALSE(MakeCentreKeys(folder.Path() / "centre", "seven green herons").ok()) << "nor is a key";
}

TEST(Exam, IsOpenedWithoutShowingItsSeed) {
  test::TemporaryFolder folder;
  assessment::ExamSettings settings;
  settings.name = "Finals", settings.task = "peg_transfer", settings.level = "normal";
  const auto sealed = assessment::SealExam(settings);
  ASSERT_TRUE(sealed.ok());
  ASSERT_TRUE(assessment::WriteExam(folder.Path() / "finals.json", *sealed).ok());
  auto page = OpenExam(folder.Path() / "finals.json");
  ASSERT_TRUE(page.ok()) << page.error().Text();
  for (const auto& [name, value] : page->facts) {
    EXPECT_EQ(value.find(std::to_string(sealed->seed)), std::string::npos);
    EXPECT_EQ(value.find(sealed->nonce), std::string::npos);
  }
  const auto nobody = PrepareExam(*page);
  ASSERT_FALSE(nobody.ok()) << "somebody has to sit it";
  page->examinee = "T-DDDDDD";
  const auto start = PrepareExam(*page);
  ASSERT_TRUE(start.ok()) << start.error().Text();
  ASSERT_TRUE(start->exam.has_value());
  EXPECT_EQ(start->exam->examinee, "T-DDDDDD");
  EXPECT_EQ(start->exam->file, page->file);
  EXPECT_EQ(start->description.seed, sealed->seed);
}

/// An exam that the scripted expert has sat, with the centre's encrypted key.
class SatExam : public testing::Test {
 protected:
  static constexpr const char* kPassphrase = "seven green herons";

  void SetUp() override {
    assessment::ExamSettings settings;
    settings.name = "Finals", settings.task = "instrument_navigation", settings.level = "easy";
    const auto sealed = assessment::SealExam(settings);
    ASSERT_TRUE(sealed.ok());
    ASSERT_TRUE(assessment::WriteExam(Path("finals.json"), *sealed).ok());
    ASSERT_TRUE(assessment::MakeKeys(Path("centre"), kPassphrase).ok());
    access_.place = {Path("store.sqlite"), Path("files")};
    const auto pseudonym = FindPseudonym(access_, "Anna Berg");
    ASSERT_TRUE(pseudonym.ok());
    auto page = OpenExam(Path("finals.json"));
    ASSERT_TRUE(page.ok());
    page_ = *page;
    page_.examinee = *pseudonym;
    const auto start = PrepareExam(page_);
    ASSERT_TRUE(start.ok());
    page_.recording = Path("exam.trocar");
    test::RecordAttempt(page_.recording, start->description, {});
  }
  std::filesystem::path Path(const char* name) const { return folder_.Path() / name; }
  base::Result<ExamPage> Issue(const char* passphrase, const std::function<bool(double)>& progress = {}) {
    return IssueExamCertificate(access_, page_, {Path("centre.key"), passphrase}, Path("certificate.json"),
                                progress);
  }

  test::TemporaryFolder folder_;
  Access access_;
  ExamPage page_;
};

TEST_F(SatExam, IsCertifiedAndTheStoreKeepsACopy) {
  const auto issued = Issue(kPassphrase);
  ASSERT_TRUE(issued.ok()) << issued.error().Text();
  EXPECT_TRUE(issued->is_passed);
  EXPECT_EQ(issued->finding, "Passed. The certificate is signed.");
  EXPECT_EQ(issued->certificate, Path("certificate.json"));
  const auto signer = assessment::ReadPublicKey(Path("centre.pub"));
  ASSERT_TRUE(signer.ok());
  const auto verified = assessment::VerifyCertificate(Path("certificate.json"), Path("exam.trocar"), *signer);
  ASSERT_TRUE(verified.ok()) << verified.error().Text();
  EXPECT_EQ(verified->examinee, page_.examinee);
  EXPECT_TRUE(verified->is_completed);
  auto desk = OpenDesk(access_);
  ASSERT_TRUE(desk.ok());
  const auto kept = store::ListCertificates(desk->store, desk->viewer, page_.examinee);
  ASSERT_TRUE(kept.ok()) << kept.error().Text();
  ASSERT_EQ(kept->size(), 1u);
  EXPECT_EQ((*kept)[0].text, *host::ReadFile(Path("certificate.json")));
}

TEST_F(SatExam, SignsNothingWithoutThePassphraseOrWhereItIsGivenUp) {
  for (const char* wrong : {"", "seven grey herons"}) {
    const auto refused = Issue(wrong);
    ASSERT_FALSE(refused.ok()) << wrong;
    EXPECT_EQ(refused.error().code, base::ErrorCode::kKeyLocked);
  }
  const auto given_up = Issue(kPassphrase, [](double) { return false; });
  ASSERT_FALSE(given_up.ok());
  EXPECT_EQ(given_up.error().code, base::ErrorCode::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(Path("certificate.json")));
  ::setenv("TROCAR_KEY_PASSPHRASE", kPassphrase, 1);
  EXPECT_TRUE(Issue("").ok()) << "that of the environment";
  ::unsetenv("TROCAR_KEY_PASSPHRASE");
}

TEST_F(SatExam, ReplacesNoCertificateAndSaysSoBeforeTheWork) {
  ASSERT_TRUE(host::WriteFile(Path("certificate.json"), "somebody's").ok());
  bool has_worked = false;
  const auto refused = Issue(kPassphrase, [&has_worked](double) { return has_worked = true; });
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, base::ErrorCode::kFileUnwritable);
  EXPECT_FALSE(has_worked);
  EXPECT_EQ(*host::ReadFile(Path("certificate.json")), "somebody's");
}

TEST_F(SatExam, IsCertifiedWhereTheStoreIsAway) {
  ASSERT_TRUE(host::WriteFile(Path("no"), "a file where the folder should be").ok());
  access_.place.url = Path("no") / "store.sqlite";
  const auto issued = Issue(kPassphrase);
  ASSERT_TRUE(issued.ok()) << issued.error().Text();
  EXPECT_THAT(issued->finding, HasSubstr("The store does not have it yet: E-"));
  EXPECT_TRUE(std::filesystem::exists(Path("certificate.json")));
}

}  // namespace
}  // namespace trocar::centre
