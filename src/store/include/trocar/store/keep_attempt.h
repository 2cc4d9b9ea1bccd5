// SPDX-License-Identifier: Apache-2.0
/// \file keep_attempt.h  The way of an attempt into the store, for the window and the command line.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "trocar/record/recording.h"
#include "trocar/store/spool.h"

namespace trocar::store {

/// An attempt from its recording: key, task, length, and what the ending says of its outcome. Metrics are the caller's to add.
/// \param path  of the recording's file
/// \return kRecordingInvalid, kFileUnreadable
core::Result<Attempt> DescribeAttempt(const record::Recording& recording, const std::filesystem::path& path);

struct KeepReport {
  bool is_in_store = false;            ///< else it waits in the spool
  std::optional<core::Error> failure;  ///< why it waits
  std::string rebuilt;                 ///< Store::Rebuilt
};

/// Spools the attempt, then tries to deliver it and whatever else waits.
/// \return why it could not even be spooled; then it is kept nowhere
/// \note Blocks for up to StoreSettings::answer_seconds: call it from a thread of its own.
core::Result<KeepReport> KeepAttempt(const Place& place, const Attempt& attempt,
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
  core::Status Keep(const Attempt& attempt);
  /// Of the newest try; nothing where all arrived, or before it.
  std::optional<core::Error> Failure() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::store
