// SPDX-License-Identifier: Apache-2.0
/// \file group_page.h  Page of a group for an instructor: members and tasks, with the results of each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "trocar/centre/access.h"
#include "trocar/centre/result_page.h"

namespace trocar::centre {

struct GroupPage {
  struct Cell {
    std::size_t attempts = 0;
    std::string text;  ///< "4 attempts, last 71 %, best 88 %"; empty without attempts
    Tone tone = Tone::kPlain;
    bool is_passed = false;  ///< at least once
  };
  struct Member {
    std::string pseudonym, name;
    std::vector<Cell> cells;  ///< (tasks)
  };
  struct Task {
    std::string key, name;
  };
  std::vector<std::string> groups;
  std::string group;        ///< that is shown; empty where there is none
  std::vector<Task> tasks;  ///< that somebody has tried
  std::vector<Member> members;
  bool is_cut = false;  ///< there are more attempts than were counted: the newest kMostGroupAttempts
};
inline constexpr std::size_t kMostGroupAttempts = 20000;

/// \param group  name; empty: the first
/// \return the store's error
base::Result<GroupPage> LoadGroup(const Access& access, const std::string& group);

}  // namespace trocar::centre
