// SPDX-License-Identifier: Apache-2.0
/// \file state_fields.h  Vectors, poses and random streams as fields of a state.
#pragma once

#include "trocar/base/state_archive.h"
#include "trocar/math/pose.h"
#include "trocar/math/random.h"

namespace trocar::base {

template <>
inline constexpr bool kIsPlainState<math::Vec3> = sizeof(math::Vec3) == 3 * sizeof(double);
template <>
inline constexpr bool kIsPlainState<math::Quaternion> = sizeof(math::Quaternion) == 4 * sizeof(double);
template <>
inline constexpr bool kIsPlainState<math::Pose> = sizeof(math::Pose) == 7 * sizeof(double);
/// A random stream is the word that it has come to.
template <>
inline constexpr bool kIsPlainState<math::Random> = sizeof(math::Random) == sizeof(std::uint64_t);

}  // namespace trocar::base
