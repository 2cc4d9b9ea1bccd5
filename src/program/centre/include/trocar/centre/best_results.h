// SPDX-License-Identifier: Apache-2.0
/// \file best_results.h  The best that somebody has done at each task and level, for lists to choose from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "trocar/centre/access.h"
#include "trocar/centre/judged_attempt.h"

namespace trocar::centre {

struct BestResult {
  std::size_t attempts = 0;       ///< all, completed or not
  std::size_t completed = 0;      ///< of them, that count
  std::size_t unverified = 0;     ///< of all, that do not count until a replay has verified them
  std::optional<double> score;    ///< the highest of a completed attempt
  std::optional<double> seconds;  ///< the shortest of a completed attempt [s]
  bool is_score_percent = false;

  friend bool operator==(const BestResult&, const BestResult&) = default;
};

/// By task and level; an operation's normal level is empty, as recordings have it.
using BestResults = std::map<std::pair<std::string, std::string>, BestResult>;

/// Of the person's newest attempts, some thousands.
/// \return the store's error
/// \note Reads a store: not on the window's thread.
base::Result<BestResults> LoadBestResults(const Access& access);

/// What leads a person on from home: the next step of their course, and what they did last.
struct NextAndLast {
  struct Step {
    StepName name;
    std::string course, title;  ///< for a person
    std::string task;           ///< key, for its picture; empty of an operation
    std::string due;            ///< may be empty
  };
  struct Result {
    std::string title;                ///< "Peg transfer, normal"
    std::string outcome;              ///< "passed, 87.4 %, 1:52"
    std::string task;                 ///< key, for its picture
    store::Attempt attempt;           ///< without metrics
    std::filesystem::path recording;  ///< empty where it is not on this computer
  };
  std::optional<Step> next;
  std::optional<Result> last;
};

/// What LoadBestResults reads, and that.
struct HomeResults {
  BestResults best;
  NextAndLast leads;
};
/// \return the store's error
/// \note Reads a store: not on the window's thread.
base::Result<HomeResults> LoadHomeResults(const Access& access);

/// "Best 87.4 %, 1:52; 5 attempts", "Not completed in 2 attempts", "Not tried yet".
std::string DescribeBest(const BestResults& results, const std::string& task, const std::string& level);

}  // namespace trocar::centre
