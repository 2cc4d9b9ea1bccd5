// SPDX-License-Identifier: Apache-2.0
/// \file trainee_report.h  Report for a trainee and the instructor: attempts, learning, what to practise.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "trocar/report/attempt_report.h"
#include "trocar/report/document.h"

namespace trocar::report {

struct AttemptRow {
  std::string started;  ///< RFC 3339
  std::string task, level, patient;
  std::string outcome;  ///< "Completed", ...
  bool is_completed = false;
  std::optional<bool> is_passed;  ///< nothing where there are no thresholds
  std::optional<double> score;
  double seconds = 0;
  std::size_t critical_errors = 0, errors = 0;  ///< `errors` counts all
};

/// T(n) = plateau + gain n^-rate, as it was fitted elsewhere; n = 1 is the first attempt.
struct CurveFit {
  double plateau = 0, gain = 0, rate = 0;
};

/// One number over the attempts of one task.
struct LearningCurve {
  std::string task;     ///< for a person
  std::string measure;  ///< "Time"
  std::string unit;     ///< "s"; may be empty
  std::vector<double> values;
  std::optional<CurveFit> fit;
  std::optional<double> expert_mean;
};

/// As computed elsewhere: the sum starts at 0.
struct CusumChart {
  std::string task;
  std::vector<double> values;   ///< after every attempt
  double lower = 0, upper = 0;  ///< limits: below `lower` acceptable, above `upper` not
  std::string verdict;          ///< a sentence
};

/// Recommendation of what to practise, with the number of attempts that support it.
struct PractisePoint {
  std::string sentence, practise;
  std::size_t attempts = 0;  ///< in which it was said
};

struct TraineeReport {
  std::string person;                ///< pseudonym
  std::string program;               ///< version
  std::string from, until;           ///< RFC 3339 of the first and the last attempt
  std::vector<AttemptRow> attempts;  ///< in order of time
  std::vector<LearningCurve> curves;
  std::vector<CusumChart> cusums;
  std::vector<PractisePoint> practise;  ///< most often said first
};

/// Attempts that one knows the reports of, without curves' fits and CUSUM, which others compute.
/// \param reports  of one person, in order of time
TraineeReport MakeTraineeReport(const std::vector<AttemptReport>& reports);

Document MakeDocument(const TraineeReport& report);

}  // namespace trocar::report
