// SPDX-License-Identifier: Apache-2.0
/// \file task_request.h  Choice of a person from the list of tasks and operations.
#pragma once

#include <filesystem>
#include <string>

#include "trocar/files/task_file.h"
#include "trocar/scene/task.h"

namespace trocar::presenter {

/// A task with its level and seed, or a scene.
struct TaskRequest {
  std::string task;             ///< key; empty: `scene` is meant
  std::string part;             ///< of an operation; empty: the whole
  std::filesystem::path scene;  ///< file
  files::TaskChoice choice;
};

}  // namespace trocar::presenter
