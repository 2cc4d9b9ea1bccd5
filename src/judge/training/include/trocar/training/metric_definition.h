// SPDX-License-Identifier: Apache-2.0
/// \file metric_definition.h  Definitions of all metrics. They stand in docs/metrics.json, which the program carries in
/// itself; docs/metrics.md shows them to people.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trocar::training {

/// Which way a trainee improves.
enum class BetterWhen : std::uint8_t { kHigher, kLower, kNeither };
/// "higher", "lower", "neither"
std::string_view NameOf(BetterWhen better) noexcept;

/// The most that has been shown of a number or a feature. docs/evidence.md says what each is of.
enum class Evidence : std::uint8_t {
  kAnalytic,    ///< it equals a closed formula
  kMeasured,    ///< it was compared with the truth that a test knows
  kEmulated,    ///< only with a device or a person that a program plays
  kScripted,    ///< scripted people of known skill were told apart, or not
  kRealPeople,  ///< people were
  kUnvalidated  ///< nothing
};
inline constexpr std::size_t kEvidenceCount = 6;
/// "analytic", "measured against truth", "emulated", "scripted people only", "real people", "unvalidated"
std::string_view NameOf(Evidence evidence) noexcept;

/// How far a metric may move when only the measuring changes; tested with one motion of known shape.
struct MetricTolerance {
  double rate = 0;   ///< share of the value: sampled at 60 or 240 Hz instead of 120 Hz [-]
  double noise = 0;  ///< share of the value: with tracker noise of 0.2 mm rms on each axis [-]
};

struct MetricDefinition {
  std::string id;                   ///< "path_length"
  std::string name;                 ///< for a surgeon: "Path length"
  std::string about;                ///< one sentence or two
  std::string unit;                 ///< of the value, SI: "m"; "1" for a number or a share
  std::string shown_unit;           ///< for a person: "mm"; empty for none
  double shown_scale = 1;           ///< from unit to shown_unit
  std::vector<std::string> of;      ///< "attempt", "hand", "camera": what has a value
  std::vector<std::string> splits;  ///< "phase", "tool": what it is also measured for alone
  std::string frame;                ///< "world", "trocar", "picture"; empty where it has none
  std::string sampling;  ///< "resampled": even rate and low-pass; "ticks": as recorded; "events"; "end"
  std::vector<std::string> settings;  ///< MetricSettings that it depends on
  std::string formula;
  std::string undefined;  ///< when there is no value; empty: always one
  BetterWhen better = BetterWhen::kNeither;
  std::string source;
  Evidence evidence = Evidence::kUnvalidated;
  /// Name of the metric in Fundamentals of Laparoscopic Surgery, LapSim and LAP Mentor; empty where they have none, where their
  /// definition is another, or nothing is known.
  std::string fls, lapsim, lap_mentor;
  std::optional<MetricTolerance> tolerance;  ///< of what is measured on motion
};

/// Every metric, in the order of reports.
std::span<const MetricDefinition> MetricDefinitions();
/// \return nullptr for an unknown id
const MetricDefinition* FindMetric(std::string_view id);

/// "training feedback, not certified assessment": stands in every JSON and belongs on every page that shows a metric.
std::string_view MetricsDisclaimer() noexcept;

/// docs/metrics.json, as it was when the program was built.
std::string_view MetricDefinitionsJson() noexcept;
/// The page docs/metrics.md.
std::string FormatMetricDefinitionsPage();

}  // namespace trocar::training
