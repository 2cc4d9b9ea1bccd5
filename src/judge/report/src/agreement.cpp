// SPDX-License-Identifier: Apache-2.0
#include "trocar/report/agreement.h"

#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <string>
#include <vector>

namespace trocar::report {
namespace {

/// Mean squares of the analysis of variance: between subjects, within them, between raters, and what is left.
struct MeanSquares {
  double subjects = 0, within = 0, raters = 0, rest = 0;
};

MeanSquares CalcMeanSquares(std::span<const double> ratings, std::size_t n, std::size_t k) {
  std::vector<double> of_subject(n, 0), of_rater(k, 0);
  double mean = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < k; ++j) {
      const double value = ratings[i * k + j];
      of_subject[i] += value / static_cast<double>(k);
      of_rater[j] += value / static_cast<double>(n);
      mean += value / static_cast<double>(n * k);
    }
  }
  MeanSquares squares;
  for (std::size_t i = 0; i < n; ++i) {
    squares.subjects += static_cast<double>(k) * (of_subject[i] - mean) * (of_subject[i] - mean);
    for (std::size_t j = 0; j < k; ++j) {
      const double value = ratings[i * k + j], left = value - of_subject[i] - of_rater[j] + mean;
      squares.within += (value - of_subject[i]) * (value - of_subject[i]);
      squares.rest += left * left;
    }
  }
  for (std::size_t j = 0; j < k; ++j)
    squares.raters += static_cast<double>(n) * (of_rater[j] - mean) * (of_rater[j] - mean);
  squares.subjects /= static_cast<double>(n - 1);
  squares.within /= static_cast<double>(n * (k - 1));
  squares.raters /= static_cast<double>(k - 1);
  squares.rest /= static_cast<double>((n - 1) * (k - 1));
  return squares;
}

double Quantile(double probability, double a, double b) {
  return boost::math::quantile(boost::math::fisher_f(a, b), probability);
}

/// Of the mean of k raters (Spearman and Brown).
double OfMean(double icc, double k) {
  return k * icc / (1 + (k - 1) * icc);
}

/// ICC(1,1) and ICC(3,1): from the ratio of two mean squares with their degrees of freedom.
Icc FromRatio(double ratio, double k, double a, double b, double tail) {
  const double low = ratio / Quantile(tail, a, b), high = ratio * Quantile(tail, b, a);
  return {(ratio - 1) / (ratio + k - 1), (low - 1) / (low + k - 1), (high - 1) / (high + k - 1)};
}

Icc MeanFromRatio(double ratio, double a, double b, double tail) {
  return {1 - 1 / ratio, 1 - Quantile(tail, a, b) / ratio, 1 - 1 / (ratio * Quantile(tail, b, a))};
}

/// ICC(2,1), with the interval by Satterthwaite's approximation.
Icc TwoRandom(const MeanSquares& squares, double n, double k, double tail) {
  const double b = squares.subjects, j = squares.raters, e = squares.rest;
  Icc icc;
  icc.value = (b - e) / (b + (k - 1) * e + k * (j - e) / n);
  const double f = j / e, spread = n * (1 + (k - 1) * icc.value) - k * icc.value;
  const double freedom = (k - 1) * (n - 1) * std::pow(k * icc.value * f + spread, 2) /
                         ((n - 1) * std::pow(k * icc.value * f, 2) + spread * spread);
  const double upper = Quantile(tail, n - 1, freedom), lower = Quantile(tail, freedom, n - 1);
  const double raters = k * j + (k * n - k - n) * e;
  icc.low = n * (b - upper * e) / (upper * raters + n * b);
  icc.high = n * (lower * b - e) / (raters + n * lower * b);
  return icc;
}

base::Error Invalid(const std::string& what) {
  return {base::ErrorCode::kRatingInvalid, what};
}

}  // namespace

base::Result<Agreement> CalcAgreement(std::span<const double> ratings, std::size_t raters,
                                      double confidence) {
  if (raters < 2 || ratings.size() % raters != 0 || ratings.size() / raters < 2)
    return Invalid("agreement needs at least two raters who all rated the same two attempts or more");
  for (const double value : ratings) {
    if (!std::isfinite(value)) return Invalid("a rating is not a number");
  }
  if (!(confidence > 0 && confidence < 1)) return Invalid("the confidence must lie between 0 and 1");
  const std::size_t subjects = ratings.size() / raters;
  const MeanSquares squares = CalcMeanSquares(ratings, subjects, raters);
  // rounding leaves a hair where raters agree wholly
  if (squares.rest < 1e-12 * (squares.subjects + squares.raters) || squares.subjects == 0) {
    return Invalid(
        "the ratings do not vary, or differ by the same for every attempt: agreement cannot be told from "
        "chance; rate more attempts");
  }
  const auto n = static_cast<double>(subjects), k = static_cast<double>(raters);
  const double tail = 1 - (1 - confidence) / 2;
  Agreement agreement;
  agreement.subjects = subjects;
  agreement.raters = raters;
  agreement.confidence = confidence;
  const double within = squares.subjects / squares.within, rest = squares.subjects / squares.rest;
  agreement.one_random = FromRatio(within, k, n - 1, n * (k - 1), tail);
  agreement.one_random_mean = MeanFromRatio(within, n - 1, n * (k - 1), tail);
  agreement.three_fixed = FromRatio(rest, k, n - 1, (n - 1) * (k - 1), tail);
  agreement.three_fixed_mean = MeanFromRatio(rest, n - 1, (n - 1) * (k - 1), tail);
  agreement.two_random = TwoRandom(squares, n, k, tail);
  agreement.two_random_mean = {
      (squares.subjects - squares.rest) / (squares.subjects + (squares.raters - squares.rest) / n),
      OfMean(agreement.two_random.low, k), OfMean(agreement.two_random.high, k)};
  return agreement;
}

std::string_view DescribeAgreement(double icc) noexcept {
  return icc < 0.5 ? "poor" : icc < 0.75 ? "moderate" : icc < 0.9 ? "good" : "excellent";
}

}  // namespace trocar::report
