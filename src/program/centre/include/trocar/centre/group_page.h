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
  std::vector<Task> courses;  ///< that can be assigned: key and name
  bool is_cut = false;        ///< there are more attempts than were counted: the newest kMostGroupAttempts
};
inline constexpr std::size_t kMostGroupAttempts = 20000;

// what an instructor changes: each is the store's error where it refuses

/// \param name  of a group that there is not yet
base::Status MakeGroup(const Access& access, const std::string& name);
/// \param who  name or pseudonym; a name that nobody has becomes a new trainee, as at "Who are you?"
base::Status JoinGroup(const Access& access, const std::string& group, const std::string& who);
base::Status LeaveGroup(const Access& access, const std::string& group, const std::string& pseudonym);
/// \param course  key of a delivered course
/// \param due     "2026-12-31"; empty: without a date
/// \return kStoreInvalid for what is no day
base::Status AssignCourse(const Access& access, const std::string& group, const std::string& course,
                          const std::string& due);

/// \param group  name; empty: the first
/// \return the store's error
base::Result<GroupPage> LoadGroup(const Access& access, const std::string& group);

}  // namespace trocar::centre
