// SPDX-License-Identifier: Apache-2.0
/// \file task_page.h  Tasks and operations to train, the easiest first: each with its levels, a picture and one's best result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trocar/centre/best_results.h"
#include "trocar/presenter/task_request.h"

namespace trocar::presenter {

/// Which part of the list is shown.
enum class TaskSection : std::uint8_t { kAll, kBasicSkills, kOperation };

struct TaskPage {
  struct Level {
    std::string key;    ///< "easy"
    std::string about;  ///< what differs, in words; may be empty
    std::string best;   ///< one's best result at it; empty while that is not known
  };
  struct Row {
    std::string name, about;
    std::vector<Level> levels;      ///< empty: it has none
    std::filesystem::path picture;  ///< PNG; empty: none is delivered
    TaskRequest request;            ///< of which the level and the seed are chosen
  };
  struct Group {
    std::string title;
    std::vector<Row> rows;
  };
  TaskSection section = TaskSection::kAll;
  std::vector<Group> groups;
};

/// \param patient  folder of who is operated on; empty: the built-in one
/// \return the first file's error
base::Result<TaskPage> LoadTaskPage(TaskSection section, const std::filesystem::path& patient);

/// Puts the best results beside the levels; parts of an operation have none of their own.
void AddBestResults(const centre::BestResults& results, TaskPage& page);

}  // namespace trocar::presenter
