// SPDX-License-Identifier: Apache-2.0
/// \file input_codec.h  A row of inputs in few bytes, bit for bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/scene/input.h"

namespace trocar::record {

/// Joints of both hands and of the laparoscope.
inline constexpr std::size_t kJointCount = 5 * (instrument::kHandCount + 1);

/// The joints in the order of a file: left hand, right hand, laparoscope; pan, tilt, spin, depth, jaw of each.
std::array<double, kJointCount> ListJoints(const scene::Input& input) noexcept;

/// Rounds every joint to a multiple of 2^-30 rad or m (about a nanometre): far below what any hand or tracker resolves, and
/// a third of the bytes in a recording. For inputs of people and devices, before the tick that uses them.
/// \note Real-time safe. What is not finite is left as it is.
void RoundJoints(scene::Input& input) noexcept;

/// Encodes inputs one after the other. A joint costs two bits where it rests, about three bytes where it moves on the grid of
/// RoundJoints, about five elsewhere, at most nine; feet, tools and settings cost only where they change.
class InputEncoder {
 public:
  /// Appends one tick.
  void Encode(const scene::Input& input, std::vector<std::byte>& bytes);
  /// The next input is encoded as the first of a row.
  void Reset() { *this = {}; }

 private:
  scene::Input last_;
  std::array<double, kJointCount> before_last_{}, third_last_{};
};

/// Decodes what an InputEncoder wrote, this one or that of format 1, from a Reset on and in the same order.
class InputDecoder {
 public:
  /// Takes the next tick's input off the front of `bytes`.
  /// \return false where the bytes are no input; then nothing further can be decoded
  [[nodiscard]] bool Decode(std::span<const std::byte>& bytes, scene::Input& input);
  void Reset() { *this = {}; }

 private:
  scene::Input last_;
  std::array<double, kJointCount> before_last_{}, third_last_{};
};

}  // namespace trocar::record
