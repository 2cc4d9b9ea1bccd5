// SPDX-License-Identifier: Apache-2.0
/// \file slider_scale.h  From a slider's place to a value and back.
#pragma once

namespace trocar::presenter {

enum class ScaleKind {
  kLinear,
  kLogarithmic,        ///< equal steps multiply equally; min > 0
  kLogarithmicOrZero,  ///< as above from `smallest` to max, and 0 at the very left
};

struct SliderScale {
  ScaleKind kind = ScaleKind::kLinear;
  double min = 0, max = 1;
  double smallest = 0;    ///< kLogarithmicOrZero only: the value just right of 0, > 0
  bool is_whole = false;  ///< values are rounded to whole numbers
};

/// Part of a kLogarithmicOrZero slider, at its left end, that means 0 [-].
inline constexpr double kZeroPart = 0.04;

/// \param position  of the slider, 0 (left) to 1 (right); beyond is clamped, NaN is 0
/// \return value within [min, max]
double ValueAt(const SliderScale& scale, double position) noexcept;

/// \param value  beyond [min, max] is clamped, NaN is min
/// \return position in [0, 1]
double PositionOf(const SliderScale& scale, double value) noexcept;

}  // namespace trocar::presenter
