// SPDX-License-Identifier: Apache-2.0
/// \file signal.h  Sampled signals: even resampling, zero-phase low-pass, spectrum, derivatives.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace trocar::training {

/// Values at a new constant step, from time 0 to the last sample, by cubic Hermite (Catmull-Rom)
/// interpolation.
///
/// \param values    (n) samples at 0, step, 2 step, ...
/// \param step      [s], > 0 (TROCAR_ASSERT)
/// \param new_step  [s], > 0 (TROCAR_ASSERT)
/// \return floor((n - 1) step / new_step) + 1 values; empty for no sample
std::vector<double> ResampleEvenly(std::span<const double> values, double step, double new_step);

/// Second-order Butterworth low-pass, forward and backward: no phase shift, and both passes together
/// attenuate `cutoff_hz` to 1/sqrt(2) (each pass has its corner at cutoff / 0.802).
///
/// The ends are continued by point reflection, so that a constant or a straight ramp passes unchanged.
/// \param step       [s], > 0 (TROCAR_ASSERT)
/// \param cutoff_hz  > 0; a cutoff whose corner reaches the Nyquist frequency leaves the signal as it is
/// Source: Winter, "Biomechanics and Motor Control of Human Movement", 4th ed. 2009, section 3.4.4.2.
std::vector<double> FilterLowPass(std::span<const double> values, double step, double cutoff_hz);

/// |X_k| of the discrete Fourier transform for k < count, by a radix-2 FFT.
///
/// \param length  transform length, a power of two >= values.size(); the signal is padded with zeros
/// (TROCAR_ASSERT)
/// \param count   <= length (TROCAR_ASSERT)
std::vector<double> CalcAmplitudeSpectrum(std::span<const double> values, std::size_t length,
                                          std::size_t count);

/// First derivative by central differences, one-sided at the ends; zeros for fewer than two samples.
std::vector<double> Differentiate(std::span<const double> values, double step);

}  // namespace trocar::training
