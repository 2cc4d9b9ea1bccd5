// SPDX-License-Identifier: Apache-2.0
/// \file polhemus_layout.h  Lengths and marks that reading and writing of records share.
#pragma once

#include <cstddef>
#include <string_view>

#include "trocar/device/polhemus.h"

namespace trocar::device {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kMetresPerInch = 0.0254;

inline constexpr std::size_t kFastrakHeader = 3;  // '0', station, error
inline constexpr std::size_t kColumns = 7;        // Sxxx.xx
inline constexpr std::size_t kFastrakAsciiLength = kFastrakHeader + 6 * kColumns + 2;
inline constexpr std::size_t kFastrakBinaryLength = kFastrakHeader + 7 * 4 + 1;

inline constexpr std::size_t kFrameHeader = 8;  // preamble, station, command, error, reserved, size
inline constexpr std::size_t kQuaternionPayload = 7 * 4 + 4 + 1;  // list 2,7,8,0
inline constexpr std::size_t kEulerPayload = 6 * 4 + 2;           // list 2,4,1, the trackers' default

inline bool IsFastrak(PolhemusFormat format) noexcept {
  return format == PolhemusFormat::kFastrakAscii || format == PolhemusFormat::kFastrakBinary;
}
/// First bytes of a LIBERTY or PATRIOT frame.
inline std::string_view Preamble(PolhemusFormat format) noexcept {
  return format == PolhemusFormat::kLiberty ? "LY" : "PA";
}

/// Rotation by azimuth about z, then elevation about y, then roll about x, each in the turned frame [rad].
math::Quaternion RotationFromEuler(const math::Vec3& azimuth_elevation_roll);
/// The other way round; elevation in [-pi/2, pi/2].
math::Vec3 EulerFromRotation(const math::Quaternion& rotation);

}  // namespace trocar::device
