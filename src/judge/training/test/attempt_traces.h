// SPDX-License-Identifier: Apache-2.0
/// \file attempt_traces.h  Attempts of known shape.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>

#include "trocar/training/attempt_metrics.h"

namespace trocar::training {

using HandMotion = std::function<ToolSample(double)>;

inline ToolSample TipAt(const math::Vec3& tip) {
  ToolSample sample;
  sample.tip = tip;
  return sample;
}

/// Part of a minimum-jerk movement done at time t of T [-].
inline double MinimumJerk(double t, double duration) {
  const double s = std::clamp(t / duration, 0.0, 1.0);
  return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

/// Both hands as functions of time [s].
inline AttemptTrace MakeTrace(
    double seconds, const HandMotion& left, const HandMotion& right = [](double) { return ToolSample{}; },
    double rate = 120.0) {
  AttemptTrace trace;
  trace.dt = 1.0 / rate;
  trace.tool_names = {"grasper", "hook"};
  for (int tick = 0; tick <= std::lround(seconds * rate); ++tick) {
    trace.hands[0].push_back(left(tick * trace.dt));
    trace.hands[1].push_back(right(tick * trace.dt));
  }
  return trace;
}

inline AttemptMetrics Measure(const AttemptTrace& trace, const MetricSettings& settings = {}) {
  base::Result<AttemptMetrics> metrics = CalcAttemptMetrics(trace, settings);
  EXPECT_TRUE(metrics.ok());
  return metrics.ok() ? std::move(*metrics) : AttemptMetrics{};
}

/// The value, or NaN where it is undefined, which no comparison forgives.
inline double ValueOf(const AttemptMetrics& metrics, std::string_view metric, std::string_view hand = "left",
                      std::string_view phase = "", std::string_view tool = "") {
  const double* value = metrics.Find(metric, hand, phase, tool);
  return value == nullptr ? std::nan("") : *value;
}

}  // namespace trocar::training
