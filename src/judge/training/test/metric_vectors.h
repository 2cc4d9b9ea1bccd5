// SPDX-License-Identifier: Apache-2.0
/// \file metric_vectors.h  tests/metrics/vectors: traces, what an independent program made of them, and what formulas say.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar/training/metric_value.h"
#include "trocar/training/trace_file.h"

namespace trocar::training {

struct AnalyticValue {
  std::string metric, hand, why;
  double value = 0, tolerance = 0;
};

struct MetricVector {
  std::string name;
  AttemptTrace trace;
  std::vector<MetricValue> metrics;
  std::vector<AnalyticValue> analytic;
};

inline std::vector<MetricVector> ReadMetricVectors() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(TROCAR_SOURCE_DIR) /
                                                               "tests/metrics/vectors"))
    paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<MetricVector> vectors;
  for (const auto& path : paths) {
    const auto text = host::ReadFile(path);
    EXPECT_TRUE(text.ok()) << path;
    const auto json = nlohmann::json::parse(*text);
    auto trace = ParseTraceJson(json.at("trace").dump(), path.filename().string());
    EXPECT_TRUE(trace.ok()) << trace.error().Text();
    MetricVector vector{path.stem().string(), std::move(*trace), {}, {}};
    for (const auto& v : json.at("metrics"))
      vector.metrics.push_back({v.at("metric"), v.at("hand"), v.at("phase"), v.at("value"), v.at("tool")});
    for (const auto& v : json.at("analytic"))
      vector.analytic.push_back(
          {v.at("metric"), v.at("hand"), v.at("why"), v.at("value"), v.at("tolerance")});
    vectors.push_back(std::move(vector));
  }
  return vectors;
}

}  // namespace trocar::training
