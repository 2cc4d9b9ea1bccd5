// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/slider_scale.h"

#include <algorithm>
#include <cmath>

namespace trocar::presenter {
namespace {

/// Like std::clamp, but NaN becomes `low`.
double Clamp(double value, double low, double high) noexcept {
  return value > low ? std::min(value, high) : low;
}

double LogValue(double low, double high, double t) noexcept {
  return low * std::pow(high / low, t);
}
double LogPosition(double low, double high, double value) noexcept {
  return std::log(value / low) / std::log(high / low);
}

}  // namespace

double ValueAt(const SliderScale& scale, double position) noexcept {
  const double t = Clamp(position, 0.0, 1.0);
  double value = scale.min;
  switch (scale.kind) {
    case ScaleKind::kLinear:
      value = scale.min + t * (scale.max - scale.min);
      break;
    case ScaleKind::kLogarithmic:
      value = LogValue(scale.min, scale.max, t);
      break;
    case ScaleKind::kLogarithmicOrZero:
      value = t < kZeroPart ? 0.0 : LogValue(scale.smallest, scale.max, (t - kZeroPart) / (1.0 - kZeroPart));
      break;
  }
  return Clamp(scale.is_whole ? std::round(value) : value, scale.min, scale.max);
}

double PositionOf(const SliderScale& scale, double value) noexcept {
  const double v = Clamp(value, scale.min, scale.max);
  switch (scale.kind) {
    case ScaleKind::kLinear:
      return (v - scale.min) / (scale.max - scale.min);
    case ScaleKind::kLogarithmic:
      return LogPosition(scale.min, scale.max, v);
    case ScaleKind::kLogarithmicOrZero:
      if (v <= 0.0) return 0.0;
      return kZeroPart +
             (1.0 - kZeroPart) * LogPosition(scale.smallest, scale.max, std::max(v, scale.smallest));
  }
  return 0.0;
}

}  // namespace trocar::presenter
