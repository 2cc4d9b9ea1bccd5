// SPDX-License-Identifier: Apache-2.0
/// \file spectrum.h  Which frequencies samples hold, by the sum that defines the Fourier transform.
#pragma once

#include <cmath>
#include <numbers>
#include <span>

#include "trocar/sound/synthesiser.h"

namespace trocar::sound {

/// Amplitude of a sine of this frequency [Hz] in the samples, through a Hann window.
inline double CalcAmplitude(std::span<const float> samples, double frequency) {
  double real = 0, imaginary = 0, window_sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double turn = 2 * std::numbers::pi;
    const double window =
        0.5 * (1 - std::cos(turn * static_cast<double>(i) / static_cast<double>(samples.size())));
    const double angle = turn * frequency * static_cast<double>(i) / kSampleRate;
    real += window * samples[i] * std::cos(angle);
    imaginary += window * samples[i] * std::sin(angle);
    window_sum += window;
  }
  return 2 * std::hypot(real, imaginary) / window_sum;
}

/// The frequency between `low` and `high` [Hz] that is loudest; to 0.1 %.
inline double FindPitch(std::span<const float> samples, double low, double high) {
  double loudest = low, most = 0;
  for (double frequency = low; frequency <= high; frequency *= 1.001) {
    const double amplitude = CalcAmplitude(samples, frequency);
    if (amplitude > most) {
      most = amplitude;
      loudest = frequency;
    }
  }
  return loudest;
}

/// Largest difference between neighbours: what an ear hears as a click.
inline double CalcLargestStep(std::span<const float> samples) {
  double largest = 0;
  for (std::size_t i = 1; i < samples.size(); ++i)
    largest = std::max(largest, std::fabs(static_cast<double>(samples[i]) - samples[i - 1]));
  return largest;
}

inline double CalcLoudest(std::span<const float> samples) {
  double loudest = 0;
  for (const float sample : samples) loudest = std::max(loudest, std::fabs(static_cast<double>(sample)));
  return loudest;
}

}  // namespace trocar::sound
