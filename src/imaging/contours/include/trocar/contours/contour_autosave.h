// SPDX-License-Identifier: Apache-2.0
/// \file contour_autosave.h  A side file that holds what is not saved yet, so that a crash costs seconds.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "trocar/base/result.h"
#include "trocar/contours/control_points.h"

namespace trocar::contours {

/// "control_points.json" has its side file in "control_points.json.autosave".
std::filesystem::path AutosavePath(const std::filesystem::path& points_file);

/// Finds the contours that an earlier program autosaved and had not saved when it ended.
///
/// A side file that cannot be read is kept under "....unreadable", where no autosave writes over it.
/// \return nothing when there is none, or when it says the same as `saved_text`; the error of a side file
/// that cannot be read
base::Result<std::optional<ControlPoints>> FindAutosaved(const std::filesystem::path& autosave_file,
                                                         const std::string& saved_text);

/// Writes the newest text it is given, on a thread of its own, at most once a period.
///
/// The file is replaced as a whole: whoever is killed while it is written leaves the last one.
class ContourAutosave {
 public:
  using Period = std::chrono::milliseconds;
  static constexpr Period kPeriod{2000};

  explicit ContourAutosave(std::filesystem::path autosave_file, Period period = kPeriod);
  /// Writes what is still waiting.
  ~ContourAutosave();
  ContourAutosave(const ContourAutosave&) = delete;
  ContourAutosave& operator=(const ContourAutosave&) = delete;

  /// Newest wins; returns at once.
  void Offer(std::string text);
  /// Everything is saved: nothing waits any more and the side file goes.
  void Discard();

  const std::filesystem::path& Path() const { return path_; }
  /// How many times it was written.
  std::size_t WrittenCount() const;
  /// Outcome of the last time.
  base::Status LastStatus() const;

 private:
  void Run();

  std::filesystem::path path_;
  Period period_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::optional<std::string> waiting_;
  bool is_ending_ = false;
  bool is_writing_ = false;
  std::size_t written_ = 0;
  base::Status status_;
  std::thread thread_;
};

}  // namespace trocar::contours
