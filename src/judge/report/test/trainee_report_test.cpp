// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/trainee_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_reports.h"

namespace trocar::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<AttemptReport> MakeReports() {
  std::vector<AttemptReport> reports;
  for (int i = 0; i < 4; ++i) {
    AttemptReport report = test::MakeTaskReport();
    report.facts.started = "2026-11-2" + std::to_string(i + 1) + "T10:00:00+01:00";
    report.seconds = 100 - 10 * i;
    report.score = 60 + 5 * i;
    reports.push_back(std::move(report));
  }
  reports[1].is_completed = false;
  reports[1].advice.resize(1);
  return reports;
}

TEST(MakeTraineeReport, PutsCompletedAttemptsIntoTheCurve) {
  const TraineeReport trainee = MakeTraineeReport(MakeReports());
  EXPECT_EQ(trainee.person, "T-7F3K2Q");
  EXPECT_EQ(trainee.attempts.size(), 4u);
  ASSERT_EQ(trainee.curves.size(), 2u);
  EXPECT_EQ(trainee.curves[0].task, "Object transport, hard");
  EXPECT_THAT(trainee.curves[0].values, ElementsAre(100, 80, 70));
  EXPECT_THAT(trainee.curves[1].values, ElementsAre(60, 70, 75));
}

TEST(MakeTraineeReport, SaysFirstWhatWasSaidMostOften) {
  const TraineeReport trainee = MakeTraineeReport(MakeReports());
  ASSERT_EQ(trainee.practise.size(), 2u);
  EXPECT_EQ(trainee.practise[0].attempts, 4u);
  EXPECT_EQ(trainee.practise[1].attempts, 3u);
  EXPECT_THAT(trainee.practise[0].practise, HasSubstr("Lift and grasp"));
}

TEST(TraineeDocument, NamesTheBestAndTheScoreOfNoneThatWasGivenUp) {
  std::vector<AttemptReport> reports = MakeReports();
  reports[1].score = 99;  // of the one that was not completed
  const Document document = MakeDocument(MakeTraineeReport(reports));
  const Table* best = nullptr;
  const Table* all = nullptr;
  for (const Section& section : document.sections) {
    for (const Block& block : section.blocks) {
      if (const Table* table = std::get_if<Table>(&block))
        (section.title == "Best attempts" ? best : all) = table;
    }
  }
  ASSERT_NE(best, nullptr);
  ASSERT_NE(all, nullptr);
  ASSERT_EQ(best->rows.size(), 1u);
  EXPECT_EQ(best->rows[0][4].text, "75");
  EXPECT_EQ(best->rows[0][5].text, "24 November 2026, 10:00");
  EXPECT_EQ(all->rows[1][4].text, "–");
  EXPECT_EQ(all->rows[1][7].text, "not completed");
}

TEST(TraineeDocument, ShowsTheCusumWithItsVerdict) {
  TraineeReport trainee = MakeTraineeReport(MakeReports());
  trainee.cusums = {{"Object transport", {-0.1, 0.8, 0.7}, -2.9, 2.9, "More attempts are needed."}};
  const std::string page = FormatHtml(MakeDocument(trainee));
  EXPECT_THAT(page, HasSubstr("Object transport: CUSUM"));
  EXPECT_THAT(page, HasSubstr("More attempts are needed."));
}

}  // namespace
}  // namespace trocar::report
