// SPDX-License-Identifier: Apache-2.0
/// \file single_precision.h  Numbers as the graphics card takes them.
#pragma once

#include <array>

#include "trocar/math/vector.h"

namespace trocar::render {

inline float ToFloat(double value) noexcept {
  return static_cast<float>(value);
}
inline std::array<float, 3> ToFloat(const math::Vec3& v) noexcept {
  return {ToFloat(v.x), ToFloat(v.y), ToFloat(v.z)};
}

}  // namespace trocar::render
