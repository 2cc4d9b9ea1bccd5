// SPDX-License-Identifier: Apache-2.0
/// \file attempt_part.h  A part of an attempt that is measured: the whole, a phase, or the time in which a hand used one tool.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/training/attempt_trace.h"
#include "trocar/training/metric_settings.h"
#include "trocar/training/metric_value.h"

namespace trocar::training {

struct AttemptPart {
  std::string phase, tool;       // empty: any
  int hand = -1;                 // whose tool; -1: both hands and the camera are measured
  std::vector<char> has_tick;    // (ticks)
  std::vector<char> has_sample;  // (samples at the even rate): that of the nearest tick
  double seconds = 0;            // a tick lasts until the next, the last one not at all [s]

  bool IsWhole() const { return phase.empty() && tool.empty(); }
  bool HasEvent(const AttemptTrace& trace, double time) const;
};

/// The whole attempt first, then its phases in the order of their first beginning, then the tools of hands that used several.
std::vector<AttemptPart> FindParts(const AttemptTrace& trace, const MetricSettings& settings);

/// "left", "right"
std::string_view HandName(int hand);

/// Where measures put their values.
class MetricList {
 public:
  void Add(std::string_view metric, const AttemptPart& part, std::string_view hand, double value) {
    values_.push_back({std::string(metric), std::string(hand), part.phase, value, part.tool});
  }
  void Add(std::string_view metric, const AttemptPart& part, std::string_view hand,
           const std::optional<double>& value) {
    if (value) Add(metric, part, hand, *value);
  }
  std::vector<MetricValue> Take() { return std::move(values_); }

 private:
  std::vector<MetricValue> values_;
};

}  // namespace trocar::training
