// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/attempt_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_reports.h"
#include "trocar/record/recording.h"

namespace trocar::report {
namespace {

using testing::HasSubstr;
using testing::Not;

template <typename T>
const T* FindBlock(const Document& document, const std::string& section) {
  for (const Section& one : document.sections) {
    if (one.title != section) continue;
    for (const Block& block : one.blocks) {
      if (const T* found = std::get_if<T>(&block)) return found;
    }
  }
  return nullptr;
}

const Tiles::Tile* FindTile(const Document& document, const std::string& label) {
  const Tiles* tiles = FindBlock<Tiles>(document, "Result");
  if (tiles == nullptr) return nullptr;
  for (const Tiles::Tile& tile : tiles->tiles) {
    if (tile.label == label) return &tile;
  }
  return nullptr;
}

TEST(MakeAttemptReport, HoldsWhatTheTraceSays) {
  const AttemptReport report = test::MakeOperationReport();
  EXPECT_EQ(report.outcome, "The operation was completed in 4 min.");
  ASSERT_EQ(report.errors.size(), 3u);
  EXPECT_EQ(report.errors[2].severity, surgery::Severity::kCritical);
  EXPECT_EQ(report.errors[2].where, "cystic duct");
  EXPECT_NEAR(*report.blood_ml, 12.5, 1e-9);
  EXPECT_NEAR(*report.critical_view_time, 0.39 * 240, 1e-9);
  EXPECT_EQ(report.phases.size(), 5u);
}

TEST(MakeAttemptReport, ShowsMetricsInThePersonsUnit) {
  const auto trace = test::MakeTrace(30, false);
  training::AttemptMetrics metrics;
  metrics.values = {{"path_length", "left", "", 1.25, ""}};
  const std::vector<MetricReference> references = {
      {"path_length", "left", "", 1.0, 0.1, {0.9, 1.4, 1.1}, true}};
  const AttemptReport report = MakeAttemptReport(trace, metrics, {test::MakeFacts(), references, {}});
  ASSERT_EQ(report.metrics.size(), 1u);
  EXPECT_EQ(report.metrics[0].name, "Path length");
  EXPECT_EQ(report.metrics[0].unit, "mm");
  EXPECT_NEAR(report.metrics[0].value, 1250, 1e-9);
  EXPECT_NEAR(*report.metrics[0].expert_mean, 1000, 1e-9);
  EXPECT_NEAR(*report.metrics[0].expert_deviation, 100, 1e-9);
  EXPECT_THAT(report.metrics[0].group, testing::ElementsAre(900, 1100, 1400));
}

// A task that ran out of time once showed a green 0.0 % and "No errors".
TEST(AttemptDocument, ATaskThatRanOutOfTimeShowsNoScoreAndNothingGreen) {
  auto trace = test::MakeTrace(30, false);
  trace.outcome = {"time_over", false, 0.0, 30};
  trace.goals[1].time.reset();
  trace.events.clear();
  const AttemptReport report =
      MakeAttemptReport(trace, test::MakeMetrics(trace), {test::MakeFacts(), {}, {}});
  EXPECT_EQ(report.outcome, "The time ran out after 30 s, with 1 of 2 goals reached.");
  const Document document = MakeDocument(report);
  ASSERT_NE(FindTile(document, "Score"), nullptr);
  EXPECT_EQ(FindTile(document, "Score")->value, "No score");
  EXPECT_NE(FindTile(document, "Score")->tone, Tone::kGood);
  EXPECT_EQ(FindTile(document, "Errors")->value, "0");
  EXPECT_NE(FindTile(document, "Errors")->tone, Tone::kGood);
  EXPECT_EQ(FindTile(document, "Goals")->tone, Tone::kCaution);
}

TEST(AttemptDocument, CriticalErrorsAndAMissedCriticalViewAreBad) {
  AttemptReport report = test::MakeOperationReport();
  report.critical_view_time.reset();
  const Document document = MakeDocument(report);
  EXPECT_EQ(FindTile(document, "Errors")->tone, Tone::kBad);
  EXPECT_EQ(FindTile(document, "Critical view of safety")->value, "not achieved");
  EXPECT_EQ(FindTile(document, "Critical view of safety")->tone, Tone::kBad);
}

TEST(AttemptDocument, SpeaksASurgeonsWords) {
  for (const AttemptReport& report : {test::MakeTaskReport(), test::MakeOperationReport()}) {
    const std::string page = FormatHtml(MakeDocument(report));
    for (const training::MetricDefinition& definition : training::MetricDefinitions()) {
      if (definition.id.find('_') != std::string::npos) {
        EXPECT_THAT(page, Not(HasSubstr(definition.id)));
      }
    }
    EXPECT_THAT(page, Not(HasSubstr("CalotTriangleDissection")));
    EXPECT_THAT(page, HasSubstr("training feedback, not certified assessment"));
  }
}

TEST(AttemptDocument, AddsUpAPhaseThatComesAgain) {
  const Document document = MakeDocument(test::MakeOperationReport());
  const Table* table = FindBlock<Table>(document, "Phases of the operation");
  ASSERT_NE(table, nullptr);
  ASSERT_EQ(table->rows.size(), 4u);
  EXPECT_EQ(table->rows[1][0].text, "Dissection of the hepatocystic triangle");
  EXPECT_EQ(table->rows[1][1].text, "1:24");  // 30 % and 5 % of four minutes
  EXPECT_EQ(table->rows[1][2].text, "35 %");
}

TEST(AttemptDocument, MarksMeasuresThatDoNotSeparateLevels) {
  const std::string page = FormatHtml(MakeDocument(test::MakeTaskReport()));
  EXPECT_THAT(page, HasSubstr("Mean speed †"));
  EXPECT_THAT(page, HasSubstr("does not tell scripted novices from scripted experts"));
  EXPECT_THAT(page, Not(HasSubstr("Path length †")));
}

TEST(AttemptDocument, ShowsTheDoubletWhereThereIsOne) {
  AttemptReport report = test::MakeOperationReport();
  EXPECT_EQ(FindBlock<Pictures>(MakeDocument(report), "Critical view of safety"), nullptr);
  report.doublet = DoubletView{"front", "back", 93.6, 121.2, "Three criteria, both views."};
  const Document document = MakeDocument(report);
  const Pictures* pictures = FindBlock<Pictures>(document, "Critical view of safety");
  ASSERT_NE(pictures, nullptr);
  EXPECT_EQ(pictures->pictures[0].caption, "From the front, at 1:34");
  EXPECT_EQ(pictures->pictures[1].caption, "From behind, at 2:01");
}

TEST(DescribeAttempt, KeepsFoldersOfThePersonOut) {
  record::Description description;
  description.name = "/home/maria/my tasks/knots.json";
  description.patient = "/home/maria/patients/p7";
  description.started = "2026-11-24T22:50:20+00:00";
  const AttemptFacts facts = DescribeAttempt(description, "Knots");
  EXPECT_EQ(facts.task_key, "knots.json");
  EXPECT_EQ(facts.patient, "p7");
  EXPECT_THAT(FormatHtml(MakeDocument(MakeAttemptReport({}, {}, {facts, {}, {}}))), Not(HasSubstr("maria")));
}

TEST(Words, SayTimesAndNumbersAsPeopleDo) {
  EXPECT_EQ(FormatClock(0), "0:00");
  EXPECT_EQ(FormatClock(67), "1:07");
  EXPECT_EQ(FormatClock(7389), "2:03:09");
  EXPECT_EQ(FormatClock(2.5), "0:02.5");
  EXPECT_EQ(FormatClock(59.6), "1:00");
  EXPECT_EQ(FormatClock(9.97), "0:10");
  EXPECT_EQ(FormatDuration(67), "67 s");
  EXPECT_EQ(FormatDuration(727), "12 min 7 s");
  EXPECT_EQ(FormatShown(1250.4), "1250");
  EXPECT_EQ(FormatShown(12.34), "12.3");
  EXPECT_EQ(FormatShown(-1.523), "-1.52");
  EXPECT_EQ(FormatShown(3), "3");
  EXPECT_EQ(FormatShown(0.0421), "0.042");
  EXPECT_EQ(FormatDate("2026-11-24T22:50:20+01:00"), "24 November 2026, 22:50");
  EXPECT_EQ(FormatDate("yesterday"), "yesterday");
}

}  // namespace
}  // namespace trocar::report
