// SPDX-License-Identifier: Apache-2.0
/// \file task_file.h  Tasks as scenes/tasks/*.json hold them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
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

/// A task's text at one level, of which scenes with other seeds are made in a fraction of the time of reading it.
/// \note Any thread may make scenes of it.
class TaskForm {
 public:
  /// \param source  its name in messages; relative paths inside start from its folder
  static base::Result<TaskForm> Parse(const std::string& text, const std::filesystem::path& source,
                                      const std::string& level);
  TaskForm(TaskForm&&) noexcept;
  TaskForm& operator=(TaskForm&&) noexcept;
  ~TaskForm();

  /// As ReadTask with this choice.
  base::Result<scene::Scene> MakeScene(std::uint64_t seed, bool is_varied,
                                       const std::filesystem::path& patient_folder = {}) const;

 private:
  struct Content;
  explicit TaskForm(std::unique_ptr<const Content> content);
  std::unique_ptr<const Content> content_;
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
