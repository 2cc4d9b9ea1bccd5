// SPDX-License-Identifier: Apache-2.0
/// \file metric_value.h  Numbers that an attempt came to, each with what it is of. training/metric_definition.h says what they mean.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trocar::training {

/// One number. What is not defined for an attempt (the efficiency of grasps that nobody tried) is absent, never NaN.
struct MetricValue {
  std::string metric;  ///< id of a definition: "path_length"
  std::string hand;    ///< "left", "right", "camera", or "" where it is of the whole attempt
  std::string phase;   ///< PhaseSpan::name, or "" of the whole attempt
  double value = 0;    ///< in the definition's unit, which is SI; finite
  std::string tool;    ///< AttemptTrace::tool_names: only while it was in use; "" with whatever tool

  friend bool operator==(const MetricValue&, const MetricValue&) = default;
};

struct AttemptMetrics {
  std::vector<MetricValue> values;  ///< in the order of the definitions

  /// \return the value, or nullptr where it is undefined; valid while `values` is not changed
  const double* Find(std::string_view metric, std::string_view hand = "", std::string_view phase = "",
                     std::string_view tool = "") const noexcept {
    for (const MetricValue& v : values) {
      if (v.metric == metric && v.hand == hand && v.phase == phase && v.tool == tool) return &v.value;
    }
    return nullptr;
  }
};

}  // namespace trocar::training
