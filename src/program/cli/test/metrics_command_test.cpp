// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar/training/metric_definition.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

using testing::HasSubstr;
using testing::Not;
/// A second and a half of the demonstration.
class MetricsCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const auto scene = std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/demonstration.json";
    const Printed run =
        RunTrocar({"simulate", scene.string(), "--ticks", "180", "--record", PathOf("a.trocar")});
    ASSERT_EQ(run.status, 0) << run.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string PathOf(const char* name) { return (folder_->Path() / name).string(); }
  static inline test::TemporaryFolder* folder_ = nullptr;
};

TEST_F(MetricsCommand, SpeaksPlainWords) {
  const Printed run = RunTrocar({"metrics", PathOf("a.trocar")});
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* word : {"Path length", "mm", "left", "right", "lower", "Smoothness of movements", "1.5 s",
                           "training feedback, not certified assessment"})
    EXPECT_THAT(run.out, HasSubstr(word));
  EXPECT_THAT(run.out, Not(HasSubstr("path_length")));
  EXPECT_THAT(run.out, Not(HasSubstr("nan")));
}

TEST_F(MetricsCommand, GivesTheSameNumbersEveryTimeAndInEveryForm) {
  const Printed run = RunTrocar({"metrics", PathOf("a.trocar"), "--json", "--trace", PathOf("t.json")});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json.at("format"), "trocar-metrics");
  EXPECT_EQ(json.at("attempt").at("player"), "script");
  ASSERT_GT(json.at("metrics").size(), 40u);
  for (const Json& value : json.at("metrics"))
    EXPECT_NE(training::FindMetric(value.at("metric").get<std::string>()), nullptr) << value;
  EXPECT_EQ(RunTrocar({"metrics", PathOf("a.trocar"), "--json", "--threads", "2"}).out, run.out);
  // what is measured can be measured elsewhere
  const Printed of_trace = RunTrocar({"metrics", PathOf("t.json"), "--json"});
  ASSERT_EQ(of_trace.status, 0) << of_trace.err;
  EXPECT_EQ(Json::parse(of_trace.out).at("metrics"), json.at("metrics"));
  const Printed csv = RunTrocar({"metrics", PathOf("a.trocar"), "--csv", "-o", PathOf("m.csv")});
  ASSERT_EQ(csv.status, 0) << csv.err;
  EXPECT_EQ(csv.out, "");
  const std::string table = *host::ReadFile(PathOf("m.csv"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')),
            json.at("metrics").size() + 1);
}

TEST_F(MetricsCommand, WritesEveryTickAsATable) {
  const Printed run = RunTrocar({"metrics", PathOf("a.trocar"), "--trace", PathOf("t.csv")});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string table = *host::ReadFile(PathOf("t.csv"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 182);
}

TEST_F(MetricsCommand, ListsWhatIsMeasured) {
  const Printed list = RunTrocar({"metrics", "--list"});
  EXPECT_EQ(list.status, 0) << list.err;
  for (const auto& d : training::MetricDefinitions()) EXPECT_THAT(list.out, HasSubstr(d.name));
  EXPECT_EQ(RunTrocar({"metrics", "--list", "--json"}).out, training::MetricDefinitionsJson());
  EXPECT_THAT(RunTrocar({"metrics", "--list", "--markdown"}).out, testing::StartsWith("# Metrics"));
}

TEST_F(MetricsCommand, RefusesWhatItCannotMeasure) {
  EXPECT_THAT(RunTrocar({"metrics", PathOf("none.trocar")}).err, HasSubstr("E-IO-001"));
  ASSERT_TRUE(host::WriteFile(PathOf("text.trocar"), "a text").ok());
  EXPECT_THAT(RunTrocar({"metrics", PathOf("text.trocar")}).err, HasSubstr("E-REC-001"));
  ASSERT_TRUE(host::WriteFile(PathOf("bad.json"), R"({"format": "trocar-scene"})").ok());
  EXPECT_THAT(RunTrocar({"metrics", PathOf("bad.json")}).err, HasSubstr("E-IO-005"));
  EXPECT_NE(RunTrocar({"metrics"}).status, 0);
}

}  // namespace
}  // namespace trocar::cli
