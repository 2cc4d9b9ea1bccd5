// SPDX-License-Identifier: Apache-2.0
/// \file validity_study.h  Which metrics find out what a scripted person was made to be.
///
/// Novices, intermediates, experts, people with one weakness, and careless ones do a task; each attempt comes to its metrics and
/// the coach's measures. The people are made by a program: what separates them here may not separate residents, but what does
/// not separate them here will hardly separate anybody.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/training/validity.h"

namespace trocar::bench {

struct StudyOptions {
  std::vector<std::string> tasks;  ///< keys of delivered tasks, or files of tasks
  std::string level = "normal";
  int people = 20;  ///< of each group
  int repeats = 2;  ///< attempts of each novice, intermediate and expert, on other seeds; 1 for all others
  /// Generated ones, on each of which every novice, intermediate and expert does a task that has a patient, the repeats on the
  /// first; 0: such a task is refused.
  int patients = 0;
  double spread = 0.2;  ///< by which people of a group differ, agent::SampleSkill
  std::uint64_t seed = 1;
  bool has_weaknesses = true;    ///< people with one weakness
  bool has_careless = true;      ///< those who commit one error each
  int jobs = 1;                  ///< attempts at a time
  double most_seconds = 0;       ///< wall clock, after which the study stops and can go on later [s]; 0: none
  std::filesystem::path folder;  ///< attempts.jsonl: what was done is not done again
};

/// One number of an attempt.
struct StudyValue {
  std::string metric, hand;
  double value = 0;
};

struct StudyAttempt {
  std::string task, group;
  int person = 0, repeat = 0;
  std::uint64_t seed = 0;
  int patient = 0;    ///< the how-manieth generated one; 0 also where the task has none
  std::string phase;  ///< how it ended, scene::PhaseName
  bool is_completed = false;
  bool is_caught = false;  ///< of a careless one: the error that it commits was found
  double seconds = 0;      ///< simulated
  std::vector<StudyValue> values;
};

/// Finding about one number of a task.
struct MetricFinding {
  std::string metric, hand;
  double novice_low = 0, novice_high = 0, novice_mean = 0;  ///< over people, in the metric's unit
  double middle_mean = 0;
  double expert_low = 0, expert_high = 0, expert_mean = 0, expert_sd = 0;
  bool separates = false;  ///< novices and experts do not overlap, and the novices' values are the worse ones
  bool is_reversed = false;  ///< they do not overlap, but the experts' values are the worse ones
  bool is_ordered = false;   ///< the intermediates' mean lies between
  double auc = 0.5;  ///< that a novice's is worse; of metrics that are better neither way, the larger side
  std::optional<double> effect;      ///< novices minus experts, pooled standard deviations
  std::optional<double> icc, alpha;  ///< over the repeats of all three levels, on the first patient
  /// ICC(1,1) over patients: first attempts of the same people, the same hands, other anatomy.
  std::optional<double> patient_icc;
  int novices = 0, experts = 0;  ///< attempts in which it was defined
};

/// Whom a number shows: of a weakness, or a careless surgeon, against experts.
struct GroupFinding {
  std::string group;
  int attempts = 0, completed = 0;
  int caught = 0;           ///< attempts in which the careless surgeon's error was found
  std::string best_metric;  ///< with hand, "path_length, left"
  double best_auc = 0.5;    ///< on either side
};

struct TaskFindings {
  std::string task, level;
  int novices = 0, middles = 0, experts = 0, completed = 0, attempts = 0;
  std::vector<MetricFinding> metrics;  ///< those that separate first, then by area under the curve
  std::vector<std::vector<std::string>> clusters;  ///< of metrics that say the same
  std::vector<GroupFinding> groups;
  std::vector<std::string> left_out;  ///< metrics that too few attempts have
};

/// Plays what is not in the folder yet.
/// \param progress  called with what is going on and the share done; may be empty
/// \return every attempt, in the order of people, repeats, tasks and groups; kUsage where the folder holds a study of other
///         options or another program; kUnknownName; kFileUnwritable. Where the time is over, the attempts so far.
base::Result<std::vector<StudyAttempt>> RunStudy(
    const StudyOptions& options, const std::function<void(const std::string&, double)>& progress = {});

/// How many attempts the options ask for. \return kUnknownName
base::Result<std::size_t> CountStudyAttempts(const StudyOptions& options);

std::vector<TaskFindings> FindOutOfStudy(const StudyOptions& options,
                                         const std::vector<StudyAttempt>& attempts);

/// For the product: assets/validity.json.
std::string FormatValidityJson(const StudyOptions& options, const std::vector<TaskFindings>& findings);
/// One page without network; one JSON with every finding; one table of every finding.
std::string FormatStudyPage(const StudyOptions& options, const std::vector<TaskFindings>& findings,
                            const std::vector<StudyAttempt>& attempts, const std::string& machine);
std::string FormatStudyJson(const StudyOptions& options, const std::vector<TaskFindings>& findings);
std::string FormatStudyCsv(const std::vector<TaskFindings>& findings);

}  // namespace trocar::bench
