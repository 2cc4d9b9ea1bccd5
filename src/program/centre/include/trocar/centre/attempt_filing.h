// SPDX-License-Identifier: Apache-2.0
/// \file attempt_filing.h  The way of every attempt from its recording into the store, beside the window: it is noted when it begins,
/// measured when it has ended, and spooled; nothing is asked.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trocar/centre/access.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/store/store.h"

namespace trocar::centre {

struct FilingStatus {
  std::size_t measuring = 0;           ///< attempts that are being measured, or wait for it
  double progress = 0;                 ///< of the one that is being measured, 0 to 1
  std::size_t waiting = 0;             ///< attempts in the spool
  std::optional<base::Error> failure;  ///< why they wait, or why the last could not be kept
};

/// An attempt that has been measured.
struct FiledAttempt {
  std::filesystem::path recording;
  std::optional<JudgedAttempt> judged;
  std::optional<base::Error> failure;  ///< why it could not be measured; it is stored nevertheless
};

/// Files attempts in the store. The next instance finishes what this one leaves: an attempt is noted on the disk when it begins.
/// Begin and End are called by the simulation's thread, all else by the window's.
class AttemptFiling {
 public:
  /// \param threads  of the solver
  /// \param on_news  called by its thread when Status or TakeFiled have changed
  AttemptFiling(Access access, int threads, std::function<void()> on_news);
  ~AttemptFiling();
  AttemptFiling(const AttemptFiling&) = delete;
  AttemptFiling& operator=(const AttemptFiling&) = delete;

  /// Sets the person of the attempts that begin from now on.
  void SetPerson(const std::string& pseudonym);
  /// A recording begins, or has ended. \note Hands over and returns.
  /// \param step  for which it is made
  void Begin(const std::filesystem::path& recording, const StepName& step = {});
  void End(const std::filesystem::path& recording);

  FilingStatus Status() const;
  /// Attempts that have been measured since the last call.
  std::vector<FiledAttempt> TakeFiled();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::centre
