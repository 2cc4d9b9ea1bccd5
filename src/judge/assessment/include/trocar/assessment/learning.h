// SPDX-License-Identifier: Apache-2.0
/// \file learning.h  How somebody learns: curve, CUSUM, percentile, trend. Pure functions of rows of numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::assessment {

/// Which way a number is better.
enum class Better { kLower, kHigher };

// --- curve

/// T(n) = plateau + gain n^-rate, n = 1 for the first attempt.
/// Source: the power law of practice, Newell, Rosenbloom, "Mechanisms of skill acquisition", 1981.
struct LearningCurve {
  double plateau = 0;  ///< A: where practice leads, >= 0, in the unit of the values
  double gain = 0;     ///< B: what practice takes off, >= 0; 0 where no learning is seen, then rate is 0
  double rate = 0;     ///< c, kLeastRate to kMostRate [-]
  double rms = 0;      ///< of what is left unexplained, in the unit of the values
  std::size_t attempts = 0;
  /// The rate lies at a bound: the attempts do not tell plateau and rate apart.
  bool is_rate_at_bound = false;

  double At(double n) const;
  /// First attempt whose expected value is at most `value`; nothing where the plateau lies above it.
  std::optional<std::size_t> AttemptsUntil(double value) const;
};

inline constexpr double kLeastRate = 0.02, kMostRate = 5.0;  // of a LearningCurve [-]
/// Three numbers need more than three attempts to be told from chance.
inline constexpr std::size_t kLeastAttempts = 6;

/// Bounded least squares: for every rate the best plateau and gain, both >= 0, in closed form; the rate by search.
/// \param values  of attempts 1, 2, ...; such that practice makes them smaller; finite
/// \return kAttemptsTooFew for less than kLeastAttempts
base::Result<LearningCurve> FitLearningCurve(std::span<const double> values);

// --- CUSUM

/// Failure rates that are told apart, and how often one may be wrong.
struct CusumSettings {
  double acceptable = 0.05;    ///< p0, failure rate of who has learnt it [-]
  double unacceptable = 0.10;  ///< p1, > p0 [-]
  double alpha = 0.05;         ///< chance to call the acceptable unacceptable, 0 to 0.5 [-]
  double beta = 0.05;          ///< chance to call the unacceptable acceptable, 0 to 0.5 [-]
};

enum class CusumVerdict {
  kUndecided,    ///< between the limits: more attempts are needed
  kAcceptable,   ///< at or below h0: the failure rate is the acceptable one
  kUnacceptable  ///< at or above h1: the failure rate is the unacceptable one
};

/// A sentence for a person: "The failure rate is acceptable."
std::string_view VerdictSentence(CusumVerdict verdict) noexcept;

struct Cusum {
  double step = 0;                                  ///< s: what a success takes off; a failure adds 1 - s
  double h0 = 0, h1 = 0;                            ///< lower limit, < 0, and upper limit, > 0
  std::vector<double> values;                       ///< S after every attempt; before the first it is 0
  CusumVerdict verdict = CusumVerdict::kUndecided;  ///< after the last
  std::optional<std::size_t> acceptable_at,
      unacceptable_at;  ///< attempts, from 0, that first reached a limit
};

/// \param failed  of every attempt in its order
/// \return kProficiencyInvalid where the settings are out of order
/// Source: Bolsin, Colson, "The use of the Cusum technique in the assessment of trainee competence in new procedures",
/// International Journal for Quality in Health Care 2000.
base::Result<Cusum> CalcCusum(const std::vector<bool>& failed, const CusumSettings& settings = {});

// --- place in a group, and trend

/// Share of a group that does worse, ties counted half, in per cent: 0 worst to 100 best.
/// \return kAttemptsTooFew for an empty group
base::Result<double> CalcPercentile(double value, std::span<const double> group, Better better);

enum class TrendVerdict { kNone, kImproving, kWorsening };

struct Trend {
  double slope = 0;        ///< median change from one attempt to the next, in the unit of the values
  double probability = 1;  ///< of such an order by chance, two-sided [-]
  TrendVerdict verdict = TrendVerdict::kNone;  ///< at kTrendProbability
};
inline constexpr std::size_t kLeastTrendAttempts = 5;
inline constexpr double kTrendProbability = 0.05;

/// \param values  of attempts in their order, finite
/// \return kAttemptsTooFew for less than kLeastTrendAttempts
/// Source: Mann 1945 and Kendall 1975 (the test, with the correction for ties), Sen 1968 (the slope).
base::Result<Trend> CalcTrend(std::span<const double> values, Better better);

}  // namespace trocar::assessment
