// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/metric_definition.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "attempt_traces.h"
#include "metric_vectors.h"
#include "trocar/host/safe_file.h"

namespace trocar::training {
namespace {

const std::filesystem::path kDocs = std::filesystem::path(TROCAR_SOURCE_DIR) / "docs";

TEST(MetricDefinitions, AreThoseOfTheDocuments) {
  const auto json = host::ReadFile(kDocs / "metrics.json");
  ASSERT_TRUE(json.ok());
  EXPECT_EQ(MetricDefinitionsJson(), *json) << "run cmake: the program carries an old docs/metrics.json";
  const auto page = host::ReadFile(kDocs / "metrics.md");
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(FormatMetricDefinitionsPage(), *page) << "trocar metrics --list --markdown -o docs/metrics.md";
}

TEST(MetricDefinitions, AreWhole) {
  std::set<std::string> ids, names;
  EXPECT_GT(MetricDefinitions().size(), 60u);
  for (const MetricDefinition& d : MetricDefinitions()) {
    EXPECT_TRUE(ids.insert(d.id).second) << d.id;
    EXPECT_TRUE(names.insert(d.name).second) << d.name;
    EXPECT_FALSE(d.name.empty() || d.about.empty() || d.unit.empty() || d.formula.empty() || d.source.empty())
        << d.id;
    EXPECT_FALSE(d.of.empty()) << d.id;
    EXPECT_GT(d.shown_scale, 0.0) << d.id;
    EXPECT_EQ(FindMetric(d.id), &d);
  }
  EXPECT_EQ(FindMetric("no_such_metric"), nullptr);
  EXPECT_EQ(MetricsDisclaimer(), nlohmann::json::parse(MetricDefinitionsJson()).at("disclaimer"));
}

TEST(MetricDefinitions, NameTheSettingsOfTheProgram) {
  const MetricSettings s;
  const std::map<std::string, double> settings = {{"sample_rate_hz", s.sample_rate_hz},
                                                  {"cutoff_hz", s.cutoff_hz},
                                                  {"jerk_cutoff_hz", s.jerk_cutoff_hz},
                                                  {"noise_step", s.noise_step},
                                                  {"angle_noise_step", s.angle_noise_step},
                                                  {"movement_start_speed", s.movement_start_speed},
                                                  {"movement_end_speed", s.movement_end_speed},
                                                  {"movement_gap", s.movement_gap},
                                                  {"idle_speed", s.idle_speed},
                                                  {"idle_window", s.idle_window},
                                                  {"idle_duration", s.idle_duration},
                                                  {"force_threshold", s.force_threshold},
                                                  {"hard_contact_depth", s.hard_contact_depth},
                                                  {"release_share", s.release_share},
                                                  {"regrasp_time", s.regrasp_time},
                                                  {"collision_gap", s.collision_gap},
                                                  {"safe_duct_distance", s.safe_duct_distance},
                                                  {"sparc_pad_level", s.sparc.pad_level},
                                                  {"sparc_cutoff_hz", s.sparc.cutoff_hz},
                                                  {"sparc_amplitude_limit", s.sparc.amplitude_limit}};
  const auto document = nlohmann::json::parse(MetricDefinitionsJson());
  EXPECT_EQ(document.at("settings").size(), settings.size());
  for (const auto& [name, setting] : document.at("settings").items()) {
    ASSERT_TRUE(settings.contains(name)) << name;
    EXPECT_EQ(setting.at("value").get<double>(), settings.at(name)) << name;
  }
  for (const MetricDefinition& d : MetricDefinitions()) {
    for (const std::string& setting : d.settings) EXPECT_TRUE(settings.contains(setting)) << d.id << setting;
  }
}

// No metric is defined and never computed, and none is computed for what its definition does not name.
TEST(MetricDefinitions, AreWhatIsComputed) {
  std::set<std::string> computed;
  for (const MetricVector& vector : ReadMetricVectors()) {
    for (const MetricValue& value : Measure(vector.trace).values) {
      computed.insert(value.metric);
      const MetricDefinition* d = FindMetric(value.metric);
      ASSERT_NE(d, nullptr) << value.metric;
      const auto has = [](const std::vector<std::string>& list, const std::string& word) {
        return std::find(list.begin(), list.end(), word) != list.end();
      };
      const std::string of = value.hand.empty() ? "attempt" : value.hand == "camera" ? "camera" : "hand";
      EXPECT_TRUE(has(d->of, of) || (value.metric == "time" && !value.tool.empty())) << value.metric << of;
      EXPECT_TRUE(value.phase.empty() || has(d->splits, "phase")) << value.metric;
      EXPECT_TRUE(value.tool.empty() || has(d->splits, "tool")) << value.metric;
    }
  }
  for (const MetricDefinition& d : MetricDefinitions()) EXPECT_TRUE(computed.contains(d.id)) << d.id;
}

// issue 47: the evidence is what there is: a study in assets/validity.json, or a formula in the test vectors.
TEST(MetricDefinitions, ClaimNoMoreEvidenceThanThereIs) {
  std::ifstream file(std::filesystem::path(TROCAR_SOURCE_DIR) / "assets/validity.json");
  std::set<std::string> studied, analytic;
  const auto validity = nlohmann::json::parse(file);
  for (const auto& task : validity.at("tasks")) {
    for (const auto& measure : task.at("measures")) studied.insert(measure.at("metric").get<std::string>());
  }
  for (const MetricVector& vector : ReadMetricVectors()) {
    for (const auto& known : vector.analytic) analytic.insert(known.metric);
  }
  for (const MetricDefinition& d : MetricDefinitions()) {
    const Evidence expected = studied.contains(d.id)    ? Evidence::kScripted
                              : analytic.contains(d.id) ? Evidence::kAnalytic
                                                        : Evidence::kUnvalidated;
    EXPECT_EQ(NameOf(d.evidence), NameOf(expected)) << d.id;
  }
}

// issue 47: our path has a dead band and a filter, so only the plain sum is called what others call it
TEST(MetricDefinitions, EquateOnlyThePlainPathWithOthers) {
  for (const char* ours : {"path_length", "economy_of_motion", "mean_speed", "angular_path"}) {
    const MetricDefinition* d = FindMetric(ours);
    EXPECT_TRUE(d->fls.empty() && d->lapsim.empty() && d->lap_mentor.empty()) << ours;
  }
  EXPECT_EQ(FindMetric("path_sum")->lapsim, "Path length");
  EXPECT_EQ(FindMetric("path_sum")->lap_mentor, "Path length");
  EXPECT_EQ(FindMetric("economy_sum")->lap_mentor, "Economy of movement");
}

TEST(FormatMetricsJson, WritesValuesWithTheirUnits) {
  AttemptMetrics metrics;
  metrics.values = {{"path_length", "left", "", 0.25, ""}, {"time", "", "Preparation", 3.0, ""}};
  const auto json = nlohmann::json::parse(FormatMetricsJson(metrics));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0],
            (nlohmann::json{{"metric", "path_length"}, {"hand", "left"}, {"value", 0.25}, {"unit", "m"}}));
  EXPECT_EQ(json[1].at("phase"), "Preparation");
  EXPECT_EQ(FormatMetricsCsv(metrics),
            "metric,hand,phase,tool,value,unit\npath_length,left,,,0.25,m\ntime,,Preparation,,3.0,s\n");
  // a trace file names its phases itself
  metrics.values = {{"time", "", "=HYPERLINK(\"x\")", 3.0, ""}};
  EXPECT_EQ(FormatMetricsCsv(metrics),
            "metric,hand,phase,tool,value,unit\ntime,,\"'=HYPERLINK(\"\"x\"\")\",,3.0,s\n");
}

}  // namespace
}  // namespace trocar::training
