// SPDX-License-Identifier: Apache-2.0
/// \file keep_attempt.h  The way of an attempt into the store, for the window and the command line.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "trocar/record/recording.h"
#include "trocar/store/spool.h"

namespace trocar::store {

/// An attempt from its recording: key, task, length, and what the ending says of its outcome. Metrics are the caller's to add.
/// \param path  of the recording's file
/// \return kRecordingInvalid, kFileUnreadable
base::Result<Attempt> DescribeAttempt(const record::Recording& recording, const std::filesystem::path& path);

/// Whether a recording is replayed, and how.
struct ReplayChoice {
  int threads = 1;  ///< of the solver; the numbers are the same for any number
  /// Told the share done, 0 to 1; false gives up. May be empty.
  std::function<bool(double)> progress;
};

/// As DescribeAttempt, with the recording played from its first tick to its last: outcome, score, metrics and length are those of
/// the replay, and the mark says how they compare with the file. Where it does not play, they are as the file says, unverified.
/// \return kRecordingInvalid, kFileUnreadable; kCancelled where `progress` gave up
/// \note Takes about as long as the attempt took, or less.
base::Result<Attempt> ReplayAttempt(record::Recording recording, const std::filesystem::path& path,
                                    const ReplayChoice& choice = {});

struct KeepReport {
  bool is_in_store = false;            ///< else it waits in the spool
  std::optional<base::Error> failure;  ///< why it waits
  std::string rebuilt;                 ///< Store::Rebuilt
};

/// Spools the attempt, then tries to deliver it and whatever else waits.
/// \return why it could not even be spooled, or is somebody else's in the store; then it is kept nowhere
/// \note Blocks for up to StoreSettings::answer_seconds: call it from a thread of its own.
base::Result<KeepReport> KeepAttempt(const Place& place, const Attempt& attempt,
                                     const StoreSettings& settings = {});

/// A thread that brings spooled attempts to the store, with growing pauses while it is away.
class Courier {
 public:
  explicit Courier(Place place, StoreSettings settings = {}, double first_seconds = 1,
                   double most_seconds = 300);
  ~Courier();
  Courier(const Courier&) = delete;
  Courier& operator=(const Courier&) = delete;

  /// Spools an attempt and wakes the thread. \return kFileUnwritable
  base::Status Keep(const Attempt& attempt);
  /// Of the newest try; nothing where all arrived, or before it.
  std::optional<base::Error> Failure() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::store
