// SPDX-License-Identifier: Apache-2.0
#include "trocar/bench/validity_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trocar/base/assert.h"

namespace trocar::bench {
namespace {

/// Ranks from 1, ties shared.
std::vector<double> CalcRanks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k) ranks[order[k]] = 0.5 * static_cast<double>(i + 1 + end);
    i = end;
  }
  return ranks;
}

std::optional<double> CalcCorrelation(std::span<const double> a, std::span<const double> b) {
  const double mean_a = CalcMean(a), mean_b = CalcMean(b);
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  if (!(aa > 0) || !(bb > 0)) return std::nullopt;
  return ab / std::sqrt(aa * bb);
}

/// Two or more people with the same number of two or more attempts.
bool IsTable(const std::vector<std::vector<double>>& attempts) {
  return attempts.size() >= 2 && attempts.front().size() >= 2 &&
         std::all_of(attempts.begin(), attempts.end(),
                     [&](const auto& one) { return one.size() == attempts.front().size(); });
}

double Square(double value) {
  return value * value;
}

}  // namespace

double CalcMean(std::span<const double> values) {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double CalcDeviation(std::span<const double> values) {
  if (values.size() < 2) return 0;
  const double mean = CalcMean(values);
  double sum = 0;
  for (const double value : values) sum += Square(value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double CalcAuc(std::span<const double> first, std::span<const double> second) {
  if (first.empty() || second.empty()) return 0.5;
  std::vector<double> all(first.begin(), first.end());
  all.insert(all.end(), second.begin(), second.end());
  const std::vector<double> ranks = CalcRanks(all);
  const double sum =
      std::accumulate(ranks.begin(), ranks.begin() + static_cast<std::ptrdiff_t>(first.size()), 0.0);
  const auto n = static_cast<double>(first.size()), m = static_cast<double>(second.size());
  return (sum - 0.5 * n * (n + 1)) / (n * m);
}

std::optional<double> CalcEffectSize(std::span<const double> first, std::span<const double> second) {
  if (first.size() < 2 || second.size() < 2) return std::nullopt;
  const auto n = static_cast<double>(first.size()), m = static_cast<double>(second.size());
  const double pooled = std::sqrt(
      ((n - 1) * Square(CalcDeviation(first)) + (m - 1) * Square(CalcDeviation(second))) / (n + m - 2));
  if (!(pooled > 0)) return std::nullopt;
  return (CalcMean(first) - CalcMean(second)) / pooled;
}

bool AreApart(std::span<const double> first, std::span<const double> second) {
  if (first.empty() || second.empty()) return false;
  const auto [low_a, high_a] = std::minmax_element(first.begin(), first.end());
  const auto [low_b, high_b] = std::minmax_element(second.begin(), second.end());
  return *high_a < *low_b || *high_b < *low_a;
}

std::optional<double> CalcIntraclassCorrelation(const std::vector<std::vector<double>>& attempts) {
  if (!IsTable(attempts)) return std::nullopt;
  const auto people = static_cast<double>(attempts.size()), k = static_cast<double>(attempts.front().size());
  double grand = 0;
  for (const auto& one : attempts) grand += CalcMean(one) / people;
  double between = 0, within = 0;
  for (const auto& one : attempts) {
    const double mean = CalcMean(one);
    between += k * Square(mean - grand);
    for (const double value : one) within += Square(value - mean);
  }
  between /= people - 1;
  within /= people * (k - 1);
  const double all = between + (k - 1) * within;
  if (!(all > 0)) return std::nullopt;
  return (between - within) / all;
}

std::optional<double> CalcCronbachAlpha(const std::vector<std::vector<double>>& attempts) {
  if (!IsTable(attempts)) return std::nullopt;
  const std::size_t k = attempts.front().size();
  double items = 0;
  std::vector<double> totals(attempts.size(), 0.0), item(attempts.size());
  for (std::size_t j = 0; j < k; ++j) {
    for (std::size_t i = 0; i < attempts.size(); ++i) {
      item[i] = attempts[i][j];
      totals[i] += item[i];
    }
    items += Square(CalcDeviation(item));
  }
  const double total = Square(CalcDeviation(totals));
  if (!(total > 0)) return std::nullopt;
  const auto count = static_cast<double>(k);
  return count / (count - 1) * (1 - items / total);
}

std::optional<double> CalcRankCorrelation(std::span<const double> first, std::span<const double> second) {
  TROCAR_ASSERT(first.size() == second.size());
  if (first.size() < 3) return std::nullopt;
  return CalcCorrelation(CalcRanks(first), CalcRanks(second));
}

std::vector<std::vector<std::size_t>> FindClusters(const std::vector<std::vector<double>>& variables,
                                                   double threshold) {
  std::vector<std::vector<double>> ranks;
  for (const auto& one : variables) ranks.push_back(CalcRanks(one));
  std::vector<std::size_t> group(variables.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < variables.size(); ++i) {
    for (std::size_t j = i + 1; j < variables.size(); ++j) {
      if (group[i] == group[j] || ranks[i].size() < 3) continue;
      const auto r = CalcCorrelation(ranks[i], ranks[j]);
      if (!r || !(std::fabs(*r) > threshold)) continue;
      const std::size_t from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  std::vector<std::vector<std::size_t>> clusters;
  for (std::size_t g = 0; g < group.size(); ++g) {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < group.size(); ++i) {
      if (group[i] == g) members.push_back(i);
    }
    if (members.size() >= 2) clusters.push_back(std::move(members));
  }
  return clusters;
}

}  // namespace trocar::bench
