// SPDX-License-Identifier: Apache-2.0
/// \file proficiency.h  Thresholds of proficiency for an attempt, as data with sources, and the judgement of an attempt by them.
/// Files: assets/proficiency/*.json, schemas/proficiency.schema.json; docs/courses.md explains them.
///
/// Training feedback, not certified assessment: docs/intended-use.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/assessment/learning.h"
#include "trocar/base/result.h"
#include "trocar/training/metric_value.h"

namespace trocar::host {
class JsonView;
}

namespace trocar::assessment {

/// Why a threshold is there: an attempt passes when it was completed and every threshold of every purpose is met.
enum class Purpose { kSafety, kTime, kEconomy, kQuality };
/// "safety", "time", "economy", "quality"
std::string_view NameOf(Purpose purpose) noexcept;

/// Of what a number is: training::MetricValue without its value and tool.
struct MetricKey {
  std::string metric;  ///< id in docs/metrics.json
  std::string hand;    ///< "left", "right", "camera", or ""
  std::string phase;   ///< or ""
  friend bool operator==(const MetricKey&, const MetricKey&) = default;
};
/// "path_length, left hand, in ClippingCutting"
std::string TextOf(const MetricKey& key);

struct Threshold {
  MetricKey of;
  Better better = Better::kLower;  ///< kLower: at most `value` passes; kHigher: at least
  double value = 0;                ///< in the metric's unit (SI)
  Purpose purpose = Purpose::kSafety;
  bool passes_undefined = false;  ///< an attempt in which the number is not defined meets it
  std::string source;             ///< a publication, or how it was computed
};

/// How the expert set did.
struct Norm {
  MetricKey of;
  Better better = Better::kLower;
  double mean = 0, deviation = 0;  ///< deviation of the sample, n - 1
  double best_quartile = 0;        ///< a quarter of the attempts were this good or better
  std::size_t attempts = 0;
};

/// A name for how far an attempt is, by its composite.
struct Grade {
  std::string name;     ///< "expert", "intermediate", "novice"
  double at_least = 0;  ///< composite [deviations of the expert set]; the lowest grade holds below, too
};

struct Proficiency {
  std::string key;    ///< file name without its ending
  std::string task;   ///< key of a task or of an operation
  std::string level;  ///< of a task; empty of an operation
  std::string about, source;
  std::vector<Threshold> thresholds;
  std::vector<Norm> norms;
  std::vector<Grade> grades;  ///< best first; may be empty
};

/// Result of an attempt, as it is judged.
struct AttemptResult {
  bool is_completed = false;  ///< brought to its end
  training::AttemptMetrics metrics;
};

struct ThresholdVerdict {
  Threshold threshold;
  std::optional<double> value;  ///< nothing where it is not defined
  bool is_met = false;
  bool is_open = false;  ///< not met because the attempt was not finished: its value misses nothing yet
  double margin =
      0;  ///< by how much it is met (> 0) or missed (< 0), in the metric's unit; 0 where undefined
};

struct Verdict {
  bool is_completed = false;
  bool is_safe = false;                   ///< every threshold of safety is met
  bool is_passed = false;                 ///< completed, and every threshold is met
  std::vector<ThresholdVerdict> metrics;  ///< in the order of the thresholds
  std::optional<double> composite;        ///< see CalcComposite
  std::string grade;                      ///< empty without a composite or grades
};

/// One metric in deviations of the expert set, better is positive. A deviation of less than kLeastDeviationShare of the mean
/// counts as that, and no metric counts more than kMostDeviations: a set that agrees to a hair, or one bad number, must not
/// decide everything.
double CalcZScore(const Norm& norm, double value);
inline constexpr double kLeastDeviationShare = 0.05, kMostDeviations = 5.0;  // [-]

/// Mean of the z-scores of all norms that are defined in the attempt; 0 is the mean of the expert set.
/// \return nothing where there is none
std::optional<double> CalcComposite(std::span<const Norm> norms, const training::AttemptMetrics& metrics);

Verdict Judge(const Proficiency& proficiency, const AttemptResult& attempt);

// --- from attempts of experts

enum class LevelRule {
  kMean,          ///< of the experts
  kBestQuartile,  ///< of the experts
  kMidpoint       ///< half way between the means of experts and novices; needs as many novices as experts
};

struct ExpertSetSettings {
  std::string task, level;
  LevelRule rule = LevelRule::kMean;
  double slack_deviations = 0;  ///< thresholds are looser by so many deviations, >= 0
  std::string source;           ///< who the experts were, and how their attempts were made
  std::vector<Threshold> of;    ///< which metrics; `value` and `source` are computed
};

/// Fewer attempts say too little about how experts do (domain facts, section 5).
inline constexpr std::size_t kLeastExpertAttempts = 10;

/// Thresholds and norms of what experts did. Safety is not averaged: the worst of the completed expert attempts is the threshold.
/// With novices there are grades: "expert" from the tenth percentile of the experts' composites on, "intermediate" from half way
/// between that and the ninetieth of the novices', where that is lower.
/// \param novices  completed or not; may be empty but for LevelRule::kMidpoint
/// \return kAttemptsTooFew for less than kLeastExpertAttempts completed attempts, or of novices where they are needed; kProficiencyInvalid where no metric is defined
/// in all of them
base::Result<Proficiency> MakeProficiency(std::span<const AttemptResult> experts,
                                          std::span<const AttemptResult> novices,
                                          const ExpertSetSettings& settings);

// --- files

/// \return the file's error, or kProficiencyInvalid with file, JSON path and remedy
base::Result<Proficiency> ReadProficiency(const std::filesystem::path& path);
/// As ReadProficiency reads it.
std::string FormatProficiency(const Proficiency& proficiency);
/// Proficiencies that are delivered with the program, by key.
base::Result<std::vector<Proficiency>> ListProficiencies();
/// A file as it is, or the key of a delivered one. \return kUnknownName with those known
base::Result<Proficiency> FindProficiency(const std::string& name_or_path);

/// Thresholds of an array in a document; complains there.
std::vector<Threshold> ReadThresholds(const std::vector<host::JsonView>& elements);

}  // namespace trocar::assessment
