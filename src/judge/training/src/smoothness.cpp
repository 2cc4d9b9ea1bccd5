// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/smoothness.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/math/elementary.h"
#include "trocar/training/signal.h"

namespace trocar::training {
namespace {

double FindPeak(std::span<const double> speed) {
  double peak = 0.0;
  for (const double v : speed) {
    if (!std::isfinite(v)) return 0.0;
    peak = std::max(peak, std::fabs(v));
  }
  return peak;
}

}  // namespace

std::optional<double> CalcSparc(std::span<const double> speed, double sample_rate_hz,
                                const SparcSettings& settings) {
  TROCAR_ASSERT(sample_rate_hz > 0.0 && settings.pad_level >= 0 && settings.pad_level <= kMaxPadLevel);
  if (!(FindPeak(speed) > 0.0)) return std::nullopt;
  const std::size_t length = std::bit_ceil(speed.size()) << settings.pad_level;
  const double df = sample_rate_hz / static_cast<double>(length);
  const std::vector<double> spectrum = CalcAmplitudeSpectrum(speed, length, length);
  const double largest = *std::max_element(spectrum.begin(), spectrum.end());
  if (!(largest > 0.0)) return std::nullopt;

  // from the first to the last line within the cutoff that reaches the limit
  std::size_t first = length, last = 0;
  for (std::size_t k = 0; k < length && static_cast<double>(k) * df <= settings.cutoff_hz; ++k) {
    if (spectrum[k] / largest < settings.amplitude_limit) continue;
    first = std::min(first, k);
    last = k;
  }
  if (first >= last) return std::nullopt;

  // length of the curve of normalised amplitude over normalised frequency
  const double across = 1.0 / static_cast<double>(last - first);
  double arc = 0.0;
  for (std::size_t k = first; k < last; ++k) {
    const double rise = (spectrum[k + 1] - spectrum[k]) / largest;
    arc += std::sqrt(across * across + rise * rise);
  }
  return -arc;
}

std::optional<double> CalcDimensionlessJerk(std::span<const double> speed, double sample_rate_hz) {
  TROCAR_ASSERT(sample_rate_hz > 0.0);
  const double peak = FindPeak(speed);
  if (speed.size() < 3 || !(peak > 0.0)) return std::nullopt;
  const double dt = 1.0 / sample_rate_hz, duration = static_cast<double>(speed.size()) * dt;
  double sum = 0.0;
  for (std::size_t i = 2; i < speed.size(); ++i) {
    const double jerk = (speed[i] - 2.0 * speed[i - 1] + speed[i - 2]) / (dt * dt);
    sum += jerk * jerk;
  }
  const double result = -(duration * duration * duration) / (peak * peak) * sum * dt;
  return std::isfinite(result) ? std::optional(result) : std::nullopt;
}

std::optional<double> CalcLogDimensionlessJerk(std::span<const double> speed, double sample_rate_hz) {
  const std::optional<double> jerk = CalcDimensionlessJerk(speed, sample_rate_hz);
  if (!jerk || *jerk == 0.0) return std::nullopt;
  return -math::Log(std::fabs(*jerk));
}

}  // namespace trocar::training
