// SPDX-License-Identifier: Apache-2.0
/// \file metric_text.h  Metrics as a person reads them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "trocar/training/metric_definition.h"
#include "trocar/training/metric_value.h"

namespace trocar::cli {

/// One metric of a part of an attempt: its definition, and the values in shown units; empty where undefined.
struct MetricRow {
  const training::MetricDefinition* definition = nullptr;
  std::string left, right, other;  ///< `other` is of the attempt or the camera
};

/// "Path length (camera)" where hands have one, too.
std::string NameOfOther(const training::MetricDefinition& definition);

/// Rows that have a value, in the order of the definitions.
/// \param every  also those without a value
std::vector<MetricRow> MakeMetricRows(const training::AttemptMetrics& metrics, std::string_view phase = {},
                                      std::string_view tool = {}, bool every = false);

/// Of each part: tables of what the hands did and of the rest, or only the whole attempt.
/// \param has_parts  also of phases and tools
std::string FormatMetricsText(const training::AttemptMetrics& metrics, bool has_parts);

}  // namespace trocar::cli
