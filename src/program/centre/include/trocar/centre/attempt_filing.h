// SPDX-License-Identifier: Apache-2.0
/// \file attempt_filing.h  The way of every attempt into the store, beside the window: it is noted when it begins, measured while it
/// is played, and spooled when it has ended; nothing is asked. What was not measured while it was played is played again.
#pragma once

#include <array>
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

/// An attempt that has ended and is not in the store yet.
struct PendingAttempt {
  std::filesystem::path recording;
  std::string person;    ///< pseudonym; may be empty
  double progress = -1;  ///< share that has been measured; < 0: it waits
};

struct FilingStatus {
  std::size_t measuring = 0;            ///< attempts that are being measured, or wait for it
  std::size_t measured = 0;             ///< since nothing waited
  double progress = 0;                  ///< of the one that is being measured, 0 to 1
  std::vector<PendingAttempt> pending;  ///< those attempts, the next one first
  std::size_t waiting = 0;              ///< attempts in the spool
  std::optional<base::Error> failure;   ///< why they wait, or why the last could not be kept
};

/// An attempt that has been measured.
struct FiledAttempt {
  std::filesystem::path recording;
  std::optional<JudgedAttempt> judged;
  std::optional<base::Error> failure;  ///< why it could not be measured; it is stored nevertheless
};

/// An attempt that is measured while it is played. Add and End are called by the simulation's thread.
class LiveAttempt {
 public:
  explicit LiveAttempt(assessment::AttemptFold fold) : fold_(std::move(fold)) {}
  /// After each tick. \note Some microseconds.
  void Add(const simulation::Snapshot& now,
           const std::array<scene::HandControls, instrument::kHandCount>& controls) {
    fold_.Add(now, controls);
  }
  /// \param is_whole  its recording has every tick that was added: else the recording is measured
  void End(bool is_whole) { is_whole_ = is_whole; }

 private:
  friend class AttemptFiling;
  assessment::AttemptFold fold_;
  bool is_whole_ = false;
};

/// Files attempts in the store. The next instance finishes what this one leaves: an attempt is noted on the disk when it begins.
/// One thread writes notes and files what was measured while it was played, at once. Another one plays what was not, the newest
/// first, in time that nobody else wants; it gives way to a newer one and goes on with the older one where it stopped.
/// Begin, Follow and End are called by the simulation's thread, all else by the window's.
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
  /// Measures the attempt while it is played; call it where the attempt begins.
  /// \param from, until  the part of an operation; kCompleted: to the end
  std::shared_ptr<LiveAttempt> Follow(const std::filesystem::path& recording,
                                      const simulation::Simulation& simulation, assessment::Milestone from,
                                      assessment::Milestone until);
  void End(const std::filesystem::path& recording);

  FilingStatus Status() const;
  /// Attempts that have been measured since the last call.
  std::vector<FiledAttempt> TakeFiled();

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::centre
