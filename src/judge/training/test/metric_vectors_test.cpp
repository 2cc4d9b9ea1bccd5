// SPDX-License-Identifier: Apache-2.0
#include "metric_vectors.h"

#include "attempt_traces.h"

namespace trocar::training {
namespace {

constexpr double kAgreement = 1e-9, kSmallest = 1e-3;

// Every value that the independent program in tools/check-metrics computed, and no other.
TEST(MetricVectors, AgreeWithTheIndependentProgram) {
  const std::vector<MetricVector> vectors = ReadMetricVectors();
  ASSERT_GE(vectors.size(), 6u);
  for (const MetricVector& vector : vectors) {
    const AttemptMetrics metrics = Measure(vector.trace);
    EXPECT_EQ(metrics.values.size(), vector.metrics.size()) << vector.name;
    for (const MetricValue& v : vector.metrics) {
      const double* value = metrics.Find(v.metric, v.hand, v.phase, v.tool);
      ASSERT_NE(value, nullptr) << vector.name << ": " << v.metric << " " << v.hand << " " << v.phase
                                << v.tool;
      EXPECT_NEAR(*value, v.value, kAgreement * std::max(kSmallest, std::fabs(v.value)))
          << vector.name << ": " << v.metric << " " << v.hand << " " << v.phase << v.tool;
    }
  }
}

TEST(MetricVectors, AgreeWithFormulas) {
  for (const MetricVector& vector : ReadMetricVectors()) {
    const AttemptMetrics metrics = Measure(vector.trace);
    EXPECT_FALSE(vector.analytic.empty());
    for (const AnalyticValue& v : vector.analytic) {
      EXPECT_NEAR(ValueOf(metrics, v.metric, v.hand), v.value, v.tolerance)
          << vector.name << ": " << v.metric << " " << v.hand << ": " << v.why;
    }
  }
}

}  // namespace
}  // namespace trocar::training
