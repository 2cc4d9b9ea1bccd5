// SPDX-License-Identifier: Apache-2.0
/// \file state_fields.h  Vectors and poses as fields of a state.
#pragma once

#include "trocar/core/state_archive.h"
#include "trocar/math/pose.h"

namespace trocar::core {

template <>
inline constexpr bool kIsPlainState<math::Vec3> = sizeof(math::Vec3) == 3 * sizeof(double);
template <>
inline constexpr bool kIsPlainState<math::Quaternion> = sizeof(math::Quaternion) == 4 * sizeof(double);
template <>
inline constexpr bool kIsPlainState<math::Pose> = sizeof(math::Pose) == 7 * sizeof(double);

}  // namespace trocar::core
