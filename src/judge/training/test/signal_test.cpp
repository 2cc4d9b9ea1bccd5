// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "trocar/math/random.h"

namespace trocar::training {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<double> Sine(int count, double step, double frequency_hz) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(std::sin(2.0 * kPi * frequency_hz * i * step));
  return values;
}

/// Greatest magnitude in the middle half.
double MiddleAmplitude(const std::vector<double>& values) {
  double amplitude = 0;
  for (std::size_t i = values.size() / 4; i < 3 * values.size() / 4; ++i)
    amplitude = std::max(amplitude, std::fabs(values[i]));
  return amplitude;
}

TEST(ResampleEvenly, KeepsALineAndItsEnds) {
  std::vector<double> line;
  for (int i = 0; i <= 120; ++i) line.push_back(3.0 - 0.5 * i / 120.0);
  const std::vector<double> resampled = ResampleEvenly(line, 1.0 / 120.0, 0.01);
  ASSERT_EQ(resampled.size(), 101u);
  for (int i = 0; i <= 100; ++i) EXPECT_NEAR(resampled[i], 3.0 - 0.005 * i, 1e-13);
}

TEST(ResampleEvenly, FollowsASine) {
  const std::vector<double> resampled = ResampleEvenly(Sine(241, 1.0 / 120.0, 2.0), 1.0 / 120.0, 0.01);
  ASSERT_EQ(resampled.size(), 201u);
  for (int i = 2; i < 198; ++i) EXPECT_NEAR(resampled[i], std::sin(2.0 * kPi * 2.0 * i * 0.01), 1e-4);
}

TEST(ResampleEvenly, ServesOneSampleAndNone) {
  EXPECT_TRUE(ResampleEvenly({}, 0.1, 0.1).empty());
  const double one[] = {7.0};
  EXPECT_EQ(ResampleEvenly(one, 0.1, 0.01), (std::vector<double>{7.0}));
}

TEST(FilterLowPass, LeavesConstantsAndRamps) {
  std::vector<double> ramp;
  for (int i = 0; i < 300; ++i) ramp.push_back(5.0 + 0.1 * i);
  const std::vector<double> filtered = FilterLowPass(ramp, 0.01, 6.0);
  for (int i = 0; i < 300; ++i) EXPECT_NEAR(filtered[i], ramp[i], 1e-3) << i;
  const std::vector<double> constant(50, -2.0);
  for (const double value : FilterLowPass(constant, 0.01, 6.0)) EXPECT_NEAR(value, -2.0, 1e-12);
}

// Analytic: the two passes together have the squared response of one, 1 / (1 + (w / w_corner)^4) with
// prewarped frequencies; at the cutoff that is 1 / sqrt(2).
TEST(FilterLowPass, AttenuatesAsButterworthSays) {
  const double step = 0.01, corner = 6.0 / std::pow(std::sqrt(2.0) - 1.0, 0.25);
  for (const double frequency : {0.5, 2.0, 6.0, 12.0, 20.0}) {
    const double ratio = std::tan(kPi * frequency * step) / std::tan(kPi * corner * step);
    const double expected = 1.0 / (1.0 + std::pow(ratio, 4));
    EXPECT_NEAR(MiddleAmplitude(FilterLowPass(Sine(2000, step, frequency), step, 6.0)), expected, 5e-3)
        << frequency;
  }
  EXPECT_NEAR(MiddleAmplitude(FilterLowPass(Sine(2000, 0.001, 6.0), 0.001, 6.0)), 1.0 / std::sqrt(2.0), 1e-3);
}

TEST(FilterLowPass, ShiftsNoPhase) {
  std::vector<double> bell;
  for (int i = 0; i < 401; ++i) bell.push_back(std::exp(-0.005 * (i - 200) * (i - 200)));
  const std::vector<double> filtered = FilterLowPass(bell, 0.01, 6.0);
  for (int i = 0; i < 200; ++i) EXPECT_NEAR(filtered[200 - i], filtered[200 + i], 1e-9);
  EXPECT_LT(filtered[200], 1.0);
}

TEST(FilterLowPass, ServesShortSignals) {
  for (std::size_t n = 0; n < 6; ++n) {
    const std::vector<double> constant(n, 4.0);
    const std::vector<double> filtered = FilterLowPass(constant, 0.01, 6.0);
    ASSERT_EQ(filtered.size(), n);
    for (const double value : filtered) EXPECT_NEAR(value, 4.0, 1e-12);
  }
}

// Oracle: the sum that defines the transform.
TEST(CalcAmplitudeSpectrum, AgreesWithTheDirectSum) {
  math::Random random(31);
  for (const std::size_t n : {1u, 2u, 3u, 17u, 64u, 100u}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(random.Uniform(-1, 1));
    const std::size_t length = 256;
    const std::vector<double> fast = CalcAmplitudeSpectrum(values, length, length);
    for (std::size_t k = 0; k < length; ++k) {
      std::complex<double> sum = 0;
      for (std::size_t i = 0; i < n; ++i)
        sum += values[i] * std::polar(1.0, -2.0 * kPi * double(i * k % length) / length);
      ASSERT_NEAR(fast[k], std::abs(sum), 1e-12) << "n " << n << " k " << k;
    }
  }
}

TEST(Differentiate, IsExactOnAParabolaInside) {
  std::vector<double> values;
  for (int i = 0; i < 20; ++i) values.push_back(3.0 * 0.1 * i * 0.1 * i);
  const std::vector<double> slope = Differentiate(values, 0.1);
  for (int i = 1; i < 19; ++i) EXPECT_NEAR(slope[i], 6.0 * 0.1 * i, 1e-12);
  EXPECT_EQ(Differentiate(std::vector<double>{1.0}, 0.1), (std::vector<double>{0.0}));
}

}  // namespace
}  // namespace trocar::training
