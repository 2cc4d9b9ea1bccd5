// SPDX-License-Identifier: Apache-2.0
/// \file background_job.h  Work beside the window, one piece at a time, and how far it is.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "trocar/base/assert.h"

namespace trocar::gui {

/// Runs one function at a time in a thread of its own. All members belong to the window's thread.
template <typename Outcome>
class BackgroundJob {
 public:
  /// \param on_done  called by the job's thread when the outcome is there; it asks the window's thread to call Take()
  explicit BackgroundJob(std::function<void()> on_done) : on_done_(std::move(on_done)) {}
  BackgroundJob(const BackgroundJob&) = delete;
  BackgroundJob& operator=(const BackgroundJob&) = delete;
  /// Waits for the end of what runs.
  ~BackgroundJob() {
    if (thread_.joinable()) thread_.join();
  }

  /// \pre !IsRunning() (TROCAR_ASSERT)
  void Start(std::function<Outcome()> work) {
    TROCAR_ASSERT(!IsRunning());
    thread_ = std::thread([this, work = std::move(work)] {
      outcome_.emplace(work());
      on_done_();
    });
  }

  /// From Start() until Take().
  bool IsRunning() const { return thread_.joinable(); }

  /// The outcome; waits for it.
  /// \pre IsRunning() (TROCAR_ASSERT)
  Outcome Take() {
    TROCAR_ASSERT(IsRunning());
    thread_.join();
    Outcome outcome = std::move(*outcome_);
    outcome_.reset();
    return outcome;
  }

 private:
  std::function<void()> on_done_;
  std::optional<Outcome> outcome_;  // written by the thread before it calls on_done_
  std::thread thread_;
};

/// Progress of a job; written by its thread, read by the window's.
class JobProgress {
 public:
  struct Value {
    std::string what;
    double fraction = 0;  ///< [-]
  };

  void Set(std::string_view what, double fraction) {
    const std::lock_guard lock(mutex_);
    value_ = {std::string(what), fraction};
  }
  Value Get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

 private:
  mutable std::mutex mutex_;
  Value value_;  // guarded by mutex_
};

}  // namespace trocar::gui
