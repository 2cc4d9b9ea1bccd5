// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "processor_time.h"
#include "trocar/bench/benchmark.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"

namespace trocar::bench {
namespace {

constexpr std::size_t kCalls = 4000;    // few enough for the nearest cache
constexpr int kRounds = 50;             // at a time, so that a clock's grain does not matter
constexpr double kMostApart = 4.5e-16;  // two results within 1 ulp, relatively

struct Range {
  double low, high;
};
using Numbers = std::array<double, kCalls>;

Numbers Draw(math::Random& random, const Range& range) {
  Numbers numbers;
  for (double& number : numbers) number = random.Uniform(range.low, range.high);
  return numbers;
}

/// Adds the times of one call of ours and of the C library's, and how they relate.
template <typename Ours, typename Theirs>
base::Status Compare(const std::string& name, const Range& x_range, const Range& y_range,
                     const BenchmarkOptions& options, BenchmarkResult& result, const Ours& ours,
                     const Theirs& theirs) {
  math::Random random(1);
  const Numbers x = Draw(random, x_range), y = Draw(random, y_range);
  for (std::size_t i = 0; i < kCalls; ++i) {
    const double value = ours(x[i], y[i]), other = theirs(x[i], y[i]);
    if (!(std::fabs(value - other) <= kMostApart * std::fabs(other)))
      return WrongAnswer(name, "it differs from the C library's by more than two units of the last place");
  }
  double sum = 0;
  const auto measure = [&](const auto& function) {
    const double seconds = TimeShortestWork(
        1, options.repeats, [] {},
        [&] {
          for (int round = 0; round < kRounds; ++round)
            for (std::size_t i = 0; i < kCalls; ++i) sum += function(x[i], y[i]);
        });
    return 1e9 * seconds / (kRounds * static_cast<double>(kCalls));
  };
  const double our_time = measure(ours), their_time = measure(theirs);
  if (!std::isfinite(sum)) return WrongAnswer(name, "a result is no number");
  result.cases.push_back({name + "/own", our_time, "ns"});
  result.cases.push_back({name + "/libm", their_time, "ns"});
  result.ratios.push_back({name, our_time / their_time});
  return {};
}

}  // namespace

base::Result<BenchmarkResult> RunElementaryBenchmark(const BenchmarkOptions& options) {
  BenchmarkResult result;
  base::Status status;
  const auto compare = [&](const std::string& name, const Range& x, const Range& y, const auto& ours,
                           const auto& theirs) {
    if (status.ok()) status = Compare(name, x, y, options, result, ours, theirs);
  };
  // what the engine asks for: angles of a few turns, sides of centimetres, shares, times in seconds
  constexpr Range kAngle{-7, 7}, kSine{-1, 1}, kSide{-0.2, 0.2}, kNone{0, 0};
  compare(
      "sin", kAngle, kNone, [](double x, double) { return math::Sin(x); },
      [](double x, double) { return std::sin(x); });
  compare(
      "cos", kAngle, kNone, [](double x, double) { return math::Cos(x); },
      [](double x, double) { return std::cos(x); });
  compare(
      "sin and cos", kAngle, kNone,
      [](double x, double) {
        const math::SineCosine both = math::SinCos(x);
        return std::fabs(both.sine) + std::fabs(both.cosine);
      },
      [](double x, double) {
        const math::SineCosine both{std::sin(x), std::cos(x)};
        return std::fabs(both.sine) + std::fabs(both.cosine);
      });
  compare(
      "sin of large", {1e6, 1e9}, kNone, [](double x, double) { return math::Sin(x); },
      [](double x, double) { return std::sin(x); });
  compare(
      "tan", kAngle, kNone, [](double x, double) { return math::Tan(x); },
      [](double x, double) { return std::tan(x); });
  compare(
      "asin", kSine, kNone, [](double x, double) { return math::Asin(x); },
      [](double x, double) { return std::asin(x); });
  compare(
      "acos", kSine, kNone, [](double x, double) { return math::Acos(x); },
      [](double x, double) { return std::acos(x); });
  compare(
      "atan2", kSide, kSide, [](double x, double y) { return math::Atan2(y, x); },
      [](double x, double y) { return std::atan2(y, x); });
  compare(
      "exp", {-40, 10}, kNone, [](double x, double) { return math::Exp(x); },
      [](double x, double) { return std::exp(x); });
  compare(
      "log", {0, 10}, kNone, [](double x, double) { return math::Log(x); },
      [](double x, double) { return std::log(x); });
  compare(
      "log1p", {-0.9, 3}, kNone, [](double x, double) { return math::Log1p(x); },
      [](double x, double) { return std::log1p(x); });
  compare(
      "pow", {0, 1}, {0, 5}, [](double x, double y) { return math::Pow(x, y); },
      [](double x, double y) { return std::pow(x, y); });
  compare(
      "cbrt", {0, 10}, kNone, [](double x, double) { return math::Cbrt(x); },
      [](double x, double) { return std::cbrt(x); });
  compare(
      "hypot", kSide, kSide, [](double x, double y) { return math::Hypot(x, y); },
      [](double x, double y) { return std::hypot(x, y); });
  if (!status.ok()) return status.error();
  return result;
}

}  // namespace trocar::bench
