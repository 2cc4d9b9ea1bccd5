// SPDX-License-Identifier: Apache-2.0
/// \file maintenance.h  Backups and checks, export and import, and what a person may demand of their data: all of it, or none of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/store/store.h"

namespace trocar::store {

/// Writes a SQLite file with all that is in the store, of either database, as of one moment, also while others write; beside it
/// FILE.sha256, as `sha256sum -c` reads it. Makes the file anew.
/// \param file  empty: a new one in Place::BackupFolder()
/// \return where it is
base::Result<std::filesystem::path> BackUp(Store& store, const Viewer& viewer,
                                           std::filesystem::path file = {});
/// The checksum beside a backup, then every page, index and reference in it.
/// \return kStoreDamaged, kFileMissing
base::Status VerifyBackup(const std::filesystem::path& file);
/// Every page and index of a SQLite store, every reference between tables, and the standings against the metrics. \return kStoreDamaged
base::Status Verify(Store& store);

struct ImportReport {
  std::int64_t people = 0, groups = 0, courses = 0, attempts = 0;  ///< that are new
  std::int64_t known = 0;                                          ///< attempts that were there already
  std::int64_t conflicts = 0;  ///< of these, another person's here; they stay theirs
};

/// All tables as one JSON file (schemas/store-export.schema.json), row by row: nothing is held in memory whole. Names are not in it.
base::Status ExportJson(Store& store, const Viewer& viewer, const std::filesystem::path& file);
/// Attempts with their metrics, one line per number.
base::Status ExportCsv(Store& store, const Viewer& viewer, const std::filesystem::path& file);
/// Trust in a file that says that an attempt was verified.
enum class Trust : std::uint8_t {
  kNone,     ///< nothing: attempts are not verified until they are replayed here
  kAsItSays  ///< all: it is one's own backup
};
/// Adds what an export or a backup holds; what is there stays. Everything or nothing.
/// \return kJsonSyntax, kJsonField, kStoreInvalid, kStoreSchema
base::Result<ImportReport> Import(Store& store, const Viewer& viewer, const std::filesystem::path& file,
                                  Trust trust = Trust::kNone);

/// Writes all that is known of a person to a new folder: person.json, and their recordings.
/// \return how many recordings
base::Result<int> ExportPerson(Store& store, const Viewer& viewer, std::string_view pseudonym,
                               const std::filesystem::path& folder);

struct EraseReport {
  std::int64_t attempts = 0;
  int recordings = 0, spooled = 0;
  std::vector<std::string> left;  ///< recordings that are not here, or could not be removed; for a person
  /// Backups, made elsewhere, that still hold the person. Those in Place::BackupFolder() were made anew.
  std::vector<std::string> backups;
};
/// Removes a person for ever: rows, the bytes that they leave behind, waiting and journalled attempts, recordings, their name.
base::Result<EraseReport> ErasePerson(Store& store, const Viewer& viewer, std::string_view pseudonym);

/// How long attempts are kept [days]; 0: for ever.
base::Status SetRetention(Store& store, const Viewer& viewer, int days);
base::Result<int> ReadRetention(Store& store);

struct TidyReport {
  std::int64_t attempts = 0;
  int recordings = 0;
  std::int64_t due =
      0;  ///< attempts that are older than they may be, and go kGraceDays after they were found so
  std::vector<std::string> left;  ///< recordings that are not here, or could not be removed; for a person
  std::filesystem::path backup;
  /// kUsage: nothing was removed or found due, since a person has to say whether the clock and the number are right.
  std::optional<base::Error> unsure;
};
/// Between a tidying that finds an attempt too old and the first that removes it: a clock or a limit that was wrong is noticed.
inline constexpr int kGraceDays = 7;
/// Finds attempts that are older than they may be, and removes those that it found so kGraceDays ago, with their recordings; gives
/// their bytes back; makes a backup.
/// \param now_ms   [ms since 1970 UTC]
/// \param is_sure  a person has said that the clock and the number of attempts are right
base::Result<TidyReport> Tidy(Store& store, const Viewer& viewer, std::int64_t now_ms, bool is_sure = false);

/// Lets a server count its tables anew, as it does by itself after a while; worthwhile after much was added.
base::Status UpdateStatistics(Store& store);

/// How much is there.
struct StoreCounts {
  std::int64_t people = 0, groups = 0, courses = 0, attempts = 0, certificates = 0;
};
base::Result<StoreCounts> CountAll(Store& store, const Viewer& viewer);

}  // namespace trocar::store
