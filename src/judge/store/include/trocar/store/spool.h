// SPDX-License-Identifier: Apache-2.0
/// \file spool.h  Attempts wait in a folder until the store has them: what was spooled is never lost, and arrives once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/store/attempts.h"

namespace trocar::store {

/// The attempt as JSON with a checksum (schemas/attempt.schema.json).
/// \param seal  secret of this computer's store: it tells its own program's attempts from files that others put there; may be empty
std::string WriteAttemptJson(const Attempt& attempt, std::string_view seal = {});
/// \param source  for messages
/// \param seal    what it was written with; without it, or with another one, the attempt is not verified
/// \return kStoreDamaged where the checksum does not fit
base::Result<Attempt> ReadAttemptJson(std::string_view text, const std::string& source,
                                      std::string_view seal = {});

struct DeliveryReport {
  int added = 0, known = 0;  ///< `known`: the store had them already
  int held =
      0;  ///< of trainees that the store does not know, or another's in the store; they stay in the folder "held"
  int damaged = 0;                     ///< put aside in the folder "damaged"
  std::optional<base::Error> failure;  ///< why the rest waits
};

/// A folder with one file per attempt. Any number of programs may use it at once.
class Spool {
 public:
  explicit Spool(const Place& place)
      : folder_(place.SpoolFolder()),
        seal_(place.folder / "seal.key"),
        journal_(place.IsPostgres() ? std::filesystem::path() : place.JournalFolder()) {}

  /// Returns once the attempt survives a power cut.
  /// \return kFileUnwritable
  base::Status Keep(const Attempt& attempt) const;
  /// Removes an attempt that is held. \return kFileUnwritable
  base::Status TakeBack(const Attempt& attempt) const;
  /// Sends what waits, oldest first. What a SQLite store has moves to the journal, which is kept until the next backup;
  /// what a server has is removed here.
  DeliveryReport Deliver(Store& store) const;
  /// Sends held attempts again, too.
  DeliveryReport DeliverHeld(Store& store) const;
  /// Sends again what arrived since the last backup, for a store that was rebuilt. Trainees that it does not know are added.
  DeliveryReport DeliverJournal(Store& store) const;
  std::size_t CountWaiting() const;
  std::size_t CountHeld() const;
  /// Removes what a backup holds. \param before_ms  when that backup began
  void ForgetJournal(std::int64_t before_ms) const;
  /// Removes every file of one trainee, in all folders. \return how many, or why one is still there
  base::Result<int> Erase(std::string_view trainee) const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path seal_;
  std::filesystem::path journal_;  // empty: none
};

/// Waiting times between attempts to reach a store: twice as long each time, by chance up to that, so that many computers do not
/// come at once. Source: Brooker 2015, "full jitter".
class BackOff {
 public:
  explicit BackOff(std::uint64_t seed, double first_seconds = 1, double most_seconds = 300)
      : random_(seed), first_(first_seconds), most_(most_seconds) {}
  /// [s], in (0, most]
  double Next();
  void Reset() { failures_ = 0; }

 private:
  std::mt19937_64 random_;
  double first_, most_;
  int failures_ = 0;
};

}  // namespace trocar::store
