// SPDX-License-Identifier: Apache-2.0
/// \file operation_level.h  How hard an operation is made: help, bleeding, time, and who holds the camera, as data. Read from
/// assets/operation/levels.json (schemas/operation-levels.schema.json).
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "trocar/core/result.h"

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

/// Where they lie in the data folder.
inline constexpr const char* kOperationLevelsFile = "assets/operation/levels.json";

/// \return the file's error: kFileMissing, kJsonSyntax or kJsonField with the place
core::Result<std::vector<OperationLevel>> ReadOperationLevels(const std::filesystem::path& path);
/// Those that are delivered, the easiest first.
core::Result<std::vector<OperationLevel>> ListOperationLevels();
/// \param key  empty: kNormalLevel
/// \return kUnknownName with those known
core::Result<OperationLevel> FindOperationLevel(const std::string& key);

}  // namespace trocar::scene
