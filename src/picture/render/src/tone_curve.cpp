// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/tone_curve.h"

#include <algorithm>
#include <cmath>

namespace trocar::render {

double CalcShown(double light) noexcept {
  const double x = std::clamp(light, 0.0, kMostLight);
  return std::sqrt(x * (x + kFilmA) / (x * (x + kFilmB) + kFilmC));
}

double CalcLightShown(double shown) noexcept {
  const double y = std::clamp(shown, 0.0, 1.0) * std::clamp(shown, 0.0, 1.0);
  // x^2 (1 - y) + x (a - b y) - c y = 0
  const double p = kFilmA - kFilmB * y, q = 1.0 - y;
  if (q < 1e-9) return kMostLight;
  return std::min(kMostLight, (-p + std::sqrt(p * p + 4.0 * q * kFilmC * y)) / (2.0 * q));
}

}  // namespace trocar::render
