// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/report_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "sample_reports.h"

namespace trocar::report {
namespace {

using nlohmann::json;

std::vector<std::vector<std::string>> ParseCsv(const std::string& csv) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool is_quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    const char c = csv[i];
    if (c == '"' && is_quoted && i + 1 < csv.size() && csv[i + 1] == '"') {
      rows.back().back() += '"', ++i;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      rows.back().emplace_back();
    } else if (c == '\n' && !is_quoted) {
      rows.emplace_back(1);
    } else if (c != '\r' || is_quoted) {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

TEST(FormatCsv, HasEveryMetricInItsSiUnitToTheLastBit) {
  const auto trace = test::MakeTrace(60, false);
  const auto metrics = test::MakeMetrics(trace);
  AttemptFacts facts = test::MakeFacts();
  facts.level = "hard, with \"quotes\"";
  const auto rows = ParseCsv(FormatCsv(MakeAttemptReport(trace, metrics, {facts, {}, {}})));
  ASSERT_EQ(rows.size(), metrics.values.size() + 1);
  for (std::size_t i = 0; i < metrics.values.size(); ++i) {
    ASSERT_EQ(rows[i + 1].size(), rows[0].size());
    EXPECT_EQ(rows[i + 1][2], facts.level);
    EXPECT_EQ(rows[i + 1][7], metrics.values[i].metric);
    EXPECT_EQ(rows[i + 1][9], metrics.values[i].hand);
    EXPECT_NEAR(std::stod(rows[i + 1][12]), metrics.values[i].value,
                1e-15 * std::fabs(metrics.values[i].value));
    EXPECT_EQ(rows[i + 1][13], training::FindMetric(metrics.values[i].metric)->unit);
  }
}

void CollectFields(const json& value, const std::string& path, std::set<std::string>& fields) {
  if (value.is_object()) {
    for (const auto& [key, one] : value.items())
      CollectFields(one, path.empty() ? key : path + "." + key, fields);
  } else if (value.is_array()) {
    for (const json& one : value) CollectFields(one, path + "[]", fields);
  } else {
    fields.insert(path);
  }
}

TEST(DataDictionary, ExplainsEveryFieldAndEveryMetric) {
  std::set<std::string> known;
  for (const FieldMeaning& one : MakeDataDictionary()) {
    EXPECT_TRUE(known.insert(one.field).second) << one.field << " is explained twice";
    EXPECT_FALSE(one.meaning.empty() || one.source.empty()) << one.field;
  }
  for (const training::MetricDefinition& definition : training::MetricDefinitions())
    EXPECT_EQ(known.count(definition.id), 1u) << definition.id;
  for (const AttemptReport& report : {test::MakeTaskReport(), test::MakeOperationReport()}) {
    json parsed = json::parse(FormatJson(report));
    for (const char* own : {"format", "version", "disclaimer", "dictionary"}) parsed.erase(own);
    std::set<std::string> fields;
    CollectFields(parsed, "", fields);
    // what the dictionary says of every metric
    for (const char* of_definition : {"metrics[].name", "metrics[].unit", "metrics[].better"})
      fields.erase(of_definition);
    for (const std::string& field : fields) EXPECT_EQ(known.count(field), 1u) << field;
  }
}

TEST(DataDictionary, IsATableForASpreadsheet) {
  const auto rows = ParseCsv(FormatDictionaryCsv());
  EXPECT_EQ(rows.size(), MakeDataDictionary().size() + 1);
  for (const auto& row : rows) EXPECT_EQ(row.size(), 4u);
}

TEST(FormatJson, SaysNoScoreWhereTheTaskWasNotCompleted) {
  auto trace = test::MakeTrace(30, false);
  trace.outcome = {"time_over", false, 0.0, 30};
  const json parsed = json::parse(FormatJson(MakeAttemptReport(trace, {}, {test::MakeFacts(), {}, {}})));
  EXPECT_FALSE(parsed["outcome"].contains("score"));
  EXPECT_EQ(parsed["outcome"]["ending"], "time_over");
  EXPECT_EQ(parsed["outcome"]["completed"], false);
  EXPECT_EQ(parsed["disclaimer"], "training feedback, not certified assessment");
}

}  // namespace
}  // namespace trocar::report
