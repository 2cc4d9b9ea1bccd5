// SPDX-License-Identifier: Apache-2.0
/// \file task_file.h  Tasks as scenes/tasks/*.json hold them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Choices that a task file leaves open.
struct TaskChoice {
  std::string level = "normal";          ///< one of the file's
  std::uint64_t seed = 1;                ///< of its random parameters and of the scene
  std::filesystem::path patient_folder;  ///< takes the place of the scene's patient unless it is empty
  /// The seed also decides what the file lets vary (`vary`, `shuffle`): for policies that learn. People train at the
  /// standardised task.
  bool is_varied = false;
};

/// A task that is delivered.
struct TaskEntry {
  std::string key;  ///< file name without its ending: "peg_transfer"
  std::filesystem::path path;
  std::string name, about;
  std::vector<std::string> levels;
};

/// Tasks of the data folder's scenes/tasks, by key. \return kFileMissing where there is no such folder
base::Result<std::vector<TaskEntry>> ListTasks();
/// File of a task: a path as it is, or the key of a delivered one. \return kUnknownName with those known
base::Result<std::filesystem::path> FindTask(const std::string& name_or_path);
/// Scene with its task. \return as ReadScene; messages carry the file and the JSON path
base::Result<scene::Scene> ReadTask(const std::filesystem::path& path, const TaskChoice& choice = {});

}  // namespace trocar::files
