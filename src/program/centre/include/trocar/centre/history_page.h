// SPDX-License-Identifier: Apache-2.0
/// \file history_page.h  Page of a person's history: attempts by pages, and how they learn a task.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/centre/access.h"
#include "trocar/centre/result_page.h"
#include "trocar/report/drawing.h"

namespace trocar::centre {

struct HistoryQuery {
  std::string person;  ///< pseudonym; empty: everyone whom the viewer may see
  std::string task;    ///< key; empty: all
  std::string page;    ///< HistoryPage::next of the page before; empty: the newest
};

struct HistoryPage {
  struct Row {
    std::int64_t id = 0;
    std::string when, task, person, outcome, score, time;
    std::string mark;  ///< why it is not verified, in words; part of `outcome`; empty where it is
    Tone tone = Tone::kPlain;
    std::filesystem::path recording;  ///< empty where it is not on this computer
    store::Attempt attempt;           ///< without metrics
  };
  struct Task {
    std::string key, name;
  };
  /// An attempt that has ended and is not in the store yet.
  struct Pending {
    std::string when, task;
    std::filesystem::path recording;
    bool is_measured_now = false;
  };
  HistoryQuery query;
  std::string who;
  std::vector<Task> tasks;       ///< to choose from
  std::vector<Pending> pending;  ///< the next one first
  std::vector<Row> rows;         ///< the newest first
  std::string next;              ///< empty after the last page
  /// Of one task at the level of its newest attempt; empty for all tasks.
  std::string level;
  std::vector<report::Drawing> drawings;  ///< learning curve and CUSUM
  std::vector<std::string> findings;      ///< in words: curve, trend, CUSUM, place in the group
};

/// \return the store's error
base::Result<HistoryPage> LoadHistory(const Access& access, const HistoryQuery& query);

}  // namespace trocar::centre
