// SPDX-License-Identifier: Apache-2.0
/// \file result_page.h  Page of one attempt: passed or not in words, what cost most, errors, metrics, plots.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trocar/centre/access.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/report/drawing.h"
#include "trocar/report/rating.h"

namespace trocar::centre {

/// How a text is coloured; it says the same in words.
enum class Tone : std::uint8_t { kPlain, kGood, kCaution, kBad };

struct ResultPage {
  struct Tile {
    std::string label, value, note;
  };
  struct ThresholdRow {
    std::string name, value, limit, source;
    bool is_met = false;
    bool is_open = false;  ///< neither met nor missed: the attempt was not finished
  };
  struct AdviceRow {
    std::string sentence, why, practise;
    std::string exercise;        ///< key of a task; may be empty
    std::optional<double> time;  ///< of the moment to look at [s]
  };
  struct ErrorRow {
    double time = 0;  ///< [s]
    std::string clock, what, severity;
    Tone tone = Tone::kPlain;
  };
  struct MetricRow {
    std::string name, about, value, expert, best;
    bool is_outside = false;  ///< worse than the range of the expert set
  };
  std::string title, subtitle;
  std::string verdict;  ///< in words
  Tone tone = Tone::kPlain;
  std::string outcome, debriefing;
  std::optional<double> first_time;  ///< of the moment that shows it, since the attempt's first tick [s]
  std::filesystem::path moment;      ///< picture of it; empty before it is drawn
  std::string first;                 ///< what to do better first, a sentence; empty where nothing stands out
  std::vector<Tile> tiles;
  std::vector<ThresholdRow> thresholds;
  std::vector<AdviceRow> advice;
  std::vector<ErrorRow> errors;
  std::vector<MetricRow> metrics;
  std::vector<report::Drawing> drawings;
  std::filesystem::path recording;
  double begin = 0;              ///< of the recording [s]: where a replay of it begins
  report::AttemptReport report;  ///< for files
  StepName step;
};

/// \param access  of whose attempts the best are taken; nothing: there is no column of them
ResultPage MakeResultPage(const JudgedAttempt& judged, const Access* access);

/// Writes the report: HTML, PDF, CSV or JSON by the file's ending.
/// \return kFileUnwritable; kUsage for another ending
base::Status SaveReport(const report::AttemptReport& report, const std::filesystem::path& path);

// --- what people add to an attempt of the store

struct ReviewPage {
  struct Remark {
    std::string clock, text, author;
    double time = 0;  ///< [s]
  };
  struct Item {
    std::string key, name, lowest, highest;
    int points = 0;  ///< that the viewer gave; 0: none yet
  };
  struct Form {
    std::string key, name, about;
    std::vector<Item> items;
  };
  std::int64_t attempt = 0;  ///< of the store; 0: it is not there (yet)
  bool may_review = false;   ///< the viewer is an instructor or the owner
  std::vector<Remark> remarks;
  std::vector<Form> forms;
};

/// Finds the attempt by its recording. \return the store's error
base::Result<ReviewPage> LoadReview(const Access& access, const store::Attempt& attempt);
/// \param time  since the attempt's first tick [s]
base::Status KeepRemark(const Access& access, const ReviewPage& page, double time, const std::string& text);
/// Every item that has points. \return kStoreRefused where nobody has said who rates
base::Status KeepRating(const Access& access, const ReviewPage& page, const ReviewPage::Form& form);

}  // namespace trocar::centre
