// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/learning.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::assessment {
namespace {

using base::Error;
using base::ErrorCode;
using math::Exp;
using math::Log;
using math::Pow;

constexpr int kRateSteps = 240;   // of the scan over the rate, evenly in its logarithm
constexpr int kGoldenSteps = 80;  // of the search between two of them
constexpr double kGolden = 0.6180339887498949;
constexpr double kMostAttempts = 1e6;  // that AttemptsUntil looks ahead
constexpr double kSameRate = 1e-6;     // from a bound [-]

struct LineFit {
  double plateau = 0, gain = 0, error = 0;  // error: sum of squares
};

double SumOfSquares(std::span<const double> values, std::span<const double> x, double plateau, double gain) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double residual = values[i] - plateau - gain * x[i];
    sum += residual * residual;
  }
  return sum;
}

/// Least squares of plateau + gain n^-rate with both not negative.
LineFit FitLine(std::span<const double> values, double rate) {
  const std::size_t n = values.size();
  std::vector<double> x(n);
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = Pow(static_cast<double>(i + 1), -rate);
    mean_x += x[i];
    mean_y += values[i];
  }
  mean_x /= static_cast<double>(n);
  mean_y /= static_cast<double>(n);
  double xx = 0, xy = 0, raw_xx = 0, raw_xy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (values[i] - mean_y);
    raw_xx += x[i] * x[i];
    raw_xy += x[i] * values[i];
  }
  LineFit best{mean_y - xy / xx * mean_x, xy / xx, 0};
  if (best.plateau >= 0 && best.gain >= 0) {
    best.error = SumOfSquares(values, x, best.plateau, best.gain);
    return best;
  }
  // the best lies on one of the two bounds
  LineFit flat{std::max(0.0, mean_y), 0, 0}, falling{0, std::max(0.0, raw_xy / raw_xx), 0};
  flat.error = SumOfSquares(values, x, flat.plateau, flat.gain);
  falling.error = SumOfSquares(values, x, falling.plateau, falling.gain);
  return flat.error <= falling.error ? flat : falling;
}

/// The chance that a standard normal deviate lies z > 0 or more away from 0, on either side.
/// Source: Abramowitz, Stegun, "Handbook of Mathematical Functions", 1964, 26.2.11 and 26.2.14.
double CalcTwoSidedTail(double z) {
  constexpr double kFar = 3.0;  // from here on the fraction is the better one
  constexpr int kTerms = 60;
  const double twice_density = std::sqrt(2.0 / std::numbers::pi) * Exp(-0.5 * z * z);
  if (z < kFar) {
    double term = z, sum = z;
    for (int n = 1; n < kTerms; ++n) {
      term *= z * z / (2 * n + 1);
      sum += term;
    }
    return 1.0 - twice_density * sum;
  }
  double fraction = z;
  for (int n = kTerms; n > 0; --n) fraction = z + n / fraction;
  return twice_density / fraction;
}

Error TooFew(std::size_t have, std::size_t need, const char* what) {
  return {ErrorCode::kAttemptsTooFew, std::string(what) + " needs " + std::to_string(need) +
                                          " attempts or more, and there are " + std::to_string(have)};
}

}  // namespace

double LearningCurve::At(double n) const {
  return plateau + gain * Pow(n, -rate);
}

std::optional<std::size_t> LearningCurve::AttemptsUntil(double value) const {
  if (At(1) <= value) return 1;
  if (!(plateau < value) || !(gain > 0)) return std::nullopt;
  const double n = std::ceil(Pow(gain / (value - plateau), 1 / rate));
  if (!(n <= kMostAttempts)) return std::nullopt;
  return base::TruncateTo<std::size_t>(n);
}

base::Result<LearningCurve> FitLearningCurve(std::span<const double> values) {
  if (values.size() < kLeastAttempts) return TooFew(values.size(), kLeastAttempts, "a learning curve");
  const double low = Log(kLeastRate), high = Log(kMostRate);
  const auto error_at = [&](double log_rate) { return FitLine(values, Exp(log_rate)).error; };
  const auto rate_of = [&](int i) { return low + (high - low) * i / kRateSteps; };
  int best = 0;
  double least = error_at(low);
  for (int i = 1; i <= kRateSteps; ++i) {
    if (const double error = error_at(rate_of(i)); error < least) {
      least = error;
      best = i;
    }
  }
  // golden-section search between the neighbours of the best
  double a = rate_of(std::max(0, best - 1)), b = rate_of(std::min(kRateSteps, best + 1));
  for (int i = 0; i < kGoldenSteps; ++i) {
    const double left = b - kGolden * (b - a), right = a + kGolden * (b - a);
    (error_at(left) <= error_at(right) ? b : a) = error_at(left) <= error_at(right) ? right : left;
  }
  const double log_rate = 0.5 * (a + b);
  const LineFit fit = FitLine(values, Exp(log_rate));
  LearningCurve curve;
  curve.attempts = values.size();
  curve.plateau = fit.plateau;
  curve.gain = fit.gain;
  curve.rate = fit.gain > 0 ? Exp(log_rate) : 0.0;
  curve.rms = std::sqrt(fit.error / static_cast<double>(values.size()));
  curve.is_rate_at_bound = fit.gain > 0 && (log_rate - low < kSameRate || high - log_rate < kSameRate);
  return curve;
}

std::string_view VerdictSentence(CusumVerdict verdict) noexcept {
  switch (verdict) {
    case CusumVerdict::kAcceptable:
      return "The failure rate is acceptable.";
    case CusumVerdict::kUnacceptable:
      return "The failure rate is too high.";
    case CusumVerdict::kUndecided:
      break;
  }
  return "More attempts are needed to tell the failure rate.";
}

base::Result<Cusum> CalcCusum(const std::vector<bool>& failed, const CusumSettings& settings) {
  const double p0 = settings.acceptable, p1 = settings.unacceptable;
  const bool are_rates_good = p0 > 0 && p1 > p0 && p1 < 1;
  const bool are_chances_good =
      settings.alpha > 0 && settings.alpha < 0.5 && settings.beta > 0 && settings.beta < 0.5;
  if (!are_rates_good || !are_chances_good) {
    return Error{
        ErrorCode::kProficiencyInvalid,
        "a CUSUM needs 0 < acceptable < unacceptable < 1 as failure rates, and alpha and beta between 0 "
        "and 0.5; 0.05, 0.10, 0.05 and 0.05 are usual"};
  }
  const double p = Log(p1 / p0), q = Log((1 - p0) / (1 - p1));
  Cusum cusum;
  cusum.step = q / (p + q);
  cusum.h0 = -Log((1 - settings.alpha) / settings.beta) / (p + q);
  cusum.h1 = Log((1 - settings.beta) / settings.alpha) / (p + q);
  double sum = 0;
  for (std::size_t i = 0; i < failed.size(); ++i) {
    sum += failed[i] ? 1 - cusum.step : -cusum.step;
    cusum.values.push_back(sum);
    if (sum <= cusum.h0 && !cusum.acceptable_at) cusum.acceptable_at = i;
    if (sum >= cusum.h1 && !cusum.unacceptable_at) cusum.unacceptable_at = i;
  }
  cusum.verdict = sum <= cusum.h0   ? CusumVerdict::kAcceptable
                  : sum >= cusum.h1 ? CusumVerdict::kUnacceptable
                                    : CusumVerdict::kUndecided;
  return cusum;
}

base::Result<double> CalcPercentile(double value, std::span<const double> group, Better better) {
  if (group.empty()) return TooFew(0, 1, "a percentile");
  double below = 0;
  for (const double other : group) {
    const bool is_worse = better == Better::kLower ? other > value : other < value;
    below += is_worse ? 1.0 : other == value ? 0.5 : 0.0;
  }
  return 100.0 * below / static_cast<double>(group.size());
}

base::Result<Trend> CalcTrend(std::span<const double> values, Better better) {
  const std::size_t n = values.size();
  if (n < kLeastTrendAttempts) return TooFew(n, kLeastTrendAttempts, "a trend");
  std::vector<double> slopes;
  double concordance = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const double change = values[j] - values[i];
      concordance += change > 0 ? 1 : change < 0 ? -1 : 0;
      slopes.push_back(change / static_cast<double>(j - i));
    }
  }
  std::sort(slopes.begin(), slopes.end());
  Trend trend;
  const std::size_t half = slopes.size() / 2;
  trend.slope = slopes.size() % 2 == 1 ? slopes[half] : 0.5 * (slopes[half - 1] + slopes[half]);
  // variance under no trend, less what ties take away
  std::map<double, double> ties;
  for (const double value : values) ++ties[value];
  const auto term = [](double m) { return m * (m - 1) * (2 * m + 5); };
  double variance = term(static_cast<double>(n));
  for (const auto& [value, count] : ties) variance -= term(count);
  variance /= 18;
  if (variance > 0 && concordance != 0) {
    const double z = (std::fabs(concordance) - 1) / std::sqrt(variance);
    trend.probability = CalcTwoSidedTail(z);
  }
  if (trend.probability < kTrendProbability) {
    const bool falls = concordance < 0;
    trend.verdict = falls == (better == Better::kLower) ? TrendVerdict::kImproving : TrendVerdict::kWorsening;
  }
  return trend;
}

}  // namespace trocar::assessment
