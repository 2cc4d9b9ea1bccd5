// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/signal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::training {
namespace {

/// b0 + b1 z^-1 + b2 z^-2 over 1 + a1 z^-1 + a2 z^-2
struct Biquad {
  double b0, b1, b2, a1, a2;
};

/// Bilinear transform with the corner kept at `corner_hz`.
Biquad MakeButterworth(double corner_hz, double step) {
  const double k = math::Tan(std::numbers::pi * corner_hz * step);
  const double norm = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
  return {k * k * norm, 2.0 * k * k * norm, k * k * norm, 2.0 * (k * k - 1.0) * norm,
          (1.0 - std::numbers::sqrt2 * k + k * k) * norm};
}

/// One pass in place, started as if the first value had been there for ever.
void FilterForward(const Biquad& f, std::vector<double>& values) {
  // state of the transposed direct form II for a constant input and output
  double s2 = (f.b2 - f.a2) * values.front();
  double s1 = (f.b1 - f.a1) * values.front() + s2;
  for (double& value : values) {
    const double in = value;
    value = f.b0 * in + s1;
    s1 = f.b1 * in - f.a1 * value + s2;
    s2 = f.b2 * in - f.a2 * value;
  }
}

}  // namespace

std::vector<double> ResampleEvenly(std::span<const double> values, double step, double new_step) {
  TROCAR_ASSERT(step > 0.0 && new_step > 0.0);
  std::vector<double> result;
  if (values.empty()) return result;
  const std::size_t last = values.size() - 1;
  // a whole number of steps may come out a rounding error short
  const auto count = base::FloorTo<std::size_t>(static_cast<double>(last) * step / new_step + 1e-9) + 1;
  result.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = std::min(static_cast<double>(i) * new_step / step, static_cast<double>(last));
    const std::size_t k = std::min(base::TruncateTo<std::size_t>(at), last == 0 ? 0 : last - 1);
    const double t = at - static_cast<double>(k);
    const double p1 = values[k], p2 = values[std::min(k + 1, last)];
    // beyond the ends the signal goes on straight
    const double p0 = k > 0 ? values[k - 1] : 2.0 * p1 - p2;
    const double p3 = k + 2 <= last ? values[k + 2] : 2.0 * p2 - p1;
    const double m1 = 0.5 * (p2 - p0), m2 = 0.5 * (p3 - p1);
    result.push_back(p1 + t * (m1 + t * (3.0 * (p2 - p1) - 2.0 * m1 - m2 + t * (2.0 * (p1 - p2) + m1 + m2))));
  }
  return result;
}

std::vector<double> FilterLowPass(std::span<const double> values, double step, double cutoff_hz) {
  TROCAR_ASSERT(step > 0.0 && cutoff_hz > 0.0);
  std::vector<double> result(values.begin(), values.end());
  // (sqrt(2) - 1)^(1/4): two passes of this corner attenuate the cutoff as one pass would
  const double corner = cutoff_hz / 0.8022459;
  if (values.size() < 2 || corner * step >= 0.5) return result;

  // continue both ends by point reflection for about one and a half periods of the cutoff
  const auto wanted = base::CeilTo<std::size_t>(1.5 / (corner * step));
  const std::size_t pad = std::min(wanted, values.size() - 1);
  std::vector<double> padded;
  padded.reserve(values.size() + 2 * pad);
  for (std::size_t i = pad; i > 0; --i) padded.push_back(2.0 * values.front() - values[i]);
  padded.insert(padded.end(), values.begin(), values.end());
  for (std::size_t i = 1; i <= pad; ++i)
    padded.push_back(2.0 * values.back() - values[values.size() - 1 - i]);

  const Biquad filter = MakeButterworth(corner, step);
  FilterForward(filter, padded);
  std::reverse(padded.begin(), padded.end());
  FilterForward(filter, padded);
  std::reverse(padded.begin(), padded.end());
  std::copy_n(padded.begin() + static_cast<std::ptrdiff_t>(pad), values.size(), result.begin());
  return result;
}

std::vector<double> CalcAmplitudeSpectrum(std::span<const double> values, std::size_t length,
                                          std::size_t count) {
  TROCAR_ASSERT(std::has_single_bit(length) && length >= values.size() && count <= length);
  std::vector<std::complex<double>> x(length);
  // bit-reversed order
  const int bits = std::countr_zero(length);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::size_t reversed = 0;
    for (int bit = 0; bit < bits; ++bit) reversed |= ((i >> bit) & 1u) << (bits - 1 - bit);
    x[reversed] = values[i];
  }
  // roots of unity straight from sine and cosine: products of roots would lose digits
  std::vector<std::complex<double>> roots(length / 2);
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const double angle = -2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length);
    roots[i] = {math::Cos(angle), math::Sin(angle)};
  }
  for (std::size_t half = 1; half < length; half *= 2) {
    const std::size_t stride = length / (2 * half);
    for (std::size_t start = 0; start < length; start += 2 * half) {
      for (std::size_t i = 0; i < half; ++i) {
        const std::complex<double> a = x[start + i], b = x[start + i + half], w = roots[i * stride];
        const std::complex<double> turned{w.real() * b.real() - w.imag() * b.imag(),
                                          w.real() * b.imag() + w.imag() * b.real()};
        x[start + i] = a + turned;
        x[start + i + half] = a - turned;
      }
    }
  }
  std::vector<double> amplitudes(count);
  for (std::size_t i = 0; i < count; ++i) {
    amplitudes[i] = std::sqrt(x[i].real() * x[i].real() + x[i].imag() * x[i].imag());
  }
  return amplitudes;
}

std::vector<double> Differentiate(std::span<const double> values, double step) {
  TROCAR_ASSERT(step > 0.0);
  const std::size_t n = values.size();
  std::vector<double> result(n, 0.0);
  if (n < 2) return result;
  result.front() = (values[1] - values[0]) / step;
  result.back() = (values[n - 1] - values[n - 2]) / step;
  for (std::size_t i = 1; i + 1 < n; ++i) result[i] = (values[i + 1] - values[i - 1]) / (2.0 * step);
  return result;
}

}  // namespace trocar::training
