// SPDX-License-Identifier: Apache-2.0
/// \file validity_statistics.h  How well numbers tell groups apart, how well they repeat, and which say the same.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace trocar::bench {

double CalcMean(std::span<const double> values);
/// Of a sample (n - 1); 0 for fewer than two.
double CalcDeviation(std::span<const double> values);

/// Area under the ROC curve: the chance that one of `first` is greater than one of `second`, a tie counting half. 0.5 where one
/// is empty.
/// Source: Hanley and McNeil, Radiology 1982.
double CalcAuc(std::span<const double> first, std::span<const double> second);

/// Difference of the means (first minus second) over the pooled standard deviation; nothing where neither varies.
/// Source: Cohen, "Statistical Power Analysis for the Behavioral Sciences", 2nd ed. 1988.
std::optional<double> CalcEffectSize(std::span<const double> first, std::span<const double> second);

/// Whether no value of one lies within the range of the other; false where one is empty.
bool AreApart(std::span<const double> first, std::span<const double> second);

/// How much of the variance is of people, not of attempts: one-way random, single attempt, ICC(1,1).
/// \param attempts  (people) each with the same number of attempts, at least two
/// \return nothing for fewer than two people or attempts, or where nothing varies
/// Source: Shrout and Fleiss, "Intraclass correlations", Psychol Bull 1979.
std::optional<double> CalcIntraclassCorrelation(const std::vector<std::vector<double>>& attempts);

/// Consistency of a score that is summed over the attempts.
/// \param attempts  as above
/// Source: Cronbach, "Coefficient alpha and the internal structure of tests", Psychometrika 1951.
std::optional<double> CalcCronbachAlpha(const std::vector<std::vector<double>>& attempts);

/// Correlation of the ranks; ties have the mean of their ranks.
/// \return nothing for fewer than three pairs, or where one does not vary
/// \pre equal lengths (TROCAR_ASSERT)
/// Source: Spearman, Am J Psychol 1904.
std::optional<double> CalcRankCorrelation(std::span<const double> first, std::span<const double> second);

/// Groups of variables of which each is correlated with another of its group by more than `threshold`, in either sense.
/// \param variables  (variables) of equal lengths
/// \return indices, each group ascending, only groups of two or more
std::vector<std::vector<std::size_t>> FindClusters(const std::vector<std::vector<double>>& variables,
                                                   double threshold);

}  // namespace trocar::bench
