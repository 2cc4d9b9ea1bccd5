// SPDX-License-Identifier: Apache-2.0
/// \file operation_level.h  How hard an operation is made: help, bleeding, time, and who holds the camera, as data.
#pragma once

#include <limits>
#include <string>

namespace trocar::scene {

/// At which an operation is as its scene says.
inline constexpr const char* kNormalLevel = "normal";

struct OperationLevel {
  std::string key = kNormalLevel;
  std::string about;         ///< what differs, in words
  bool has_guidance = true;  ///< guides over the picture and slow motion may be used
  double time_limit = std::numeric_limits<double>::infinity();       ///< of the whole operation [s]
  double part_time_limit = std::numeric_limits<double>::infinity();  ///< of a part of it [s]
  /// JSON merge patches (RFC 7386) on the scene and on the operation's parameters; empty: nothing differs.
  std::string scene_patch, parameters_patch;

  friend bool operator==(const OperationLevel&, const OperationLevel&) = default;
};

}  // namespace trocar::scene
