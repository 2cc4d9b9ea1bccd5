// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <system_error>
#include <vector>

#include "attempt_rows.h"
#include "database.h"
#include "private_file.h"
#include "schema.h"
#include "sql.h"
#include "tables.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/sha256.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/people.h"
#include "trocar/store/spool.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

constexpr std::size_t kKeptBackups = 5;  // in the store's own folder

/// Every table of another store into an empty one, with its ids.
base::Status CopyTables(Database& from, Database& to) {
  for (const Table& table : Tables()) {
    const std::string insert = InsertText(table, true);
    auto copied = ForEachRow(from, table, [&](const Row& row) -> base::Status {
      const auto added = to.Run(insert, row.values);
      return added.ok() ? base::Status() : added.error();
    });
    if (!copied.ok()) return copied;
  }
  const auto settings = from.Run("SELECT name, value FROM setting WHERE name <> 'schema'");
  if (!settings.ok()) return settings.error();
  for (const Row& row : settings->rows) {
    if (auto added = to.Run("INSERT INTO setting (name, value) VALUES ($1, $2)", row.values); !added.ok())
      return added.error();
  }
  const auto people = to.Run("SELECT DISTINCT person_id FROM attempt WHERE person_id IS NOT NULL");
  if (!people.ok()) return people.error();
  for (const Row& row : people->rows) {
    if (auto counted = RecalcStandings(to, row.Int(0)); !counted.ok()) return counted;
  }
  return {};
}

base::Status BackUpPostgres(Database& from, const fs::path& partial) {
  auto to = OpenSqlite(partial.string(), 2);
  if (!to.ok()) return to.error();
  if (auto made = Migrate(**to, Migrations()); !made.ok()) return made.error();
  auto copied = InTransaction(from, Access::kRead, [&] {
    return InTransaction(**to, Access::kWrite, [&] { return CopyTables(from, **to); });
  });
  if (!copied.ok()) return copied;
  return (*to)->RunScript("PRAGMA journal_mode=DELETE");
}

base::Status SyncFile(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool is_synced = file >= 0 && ::fsync(file) == 0;
  const int why = errno;
  if (file >= 0) ::close(file);
  if (is_synced) return {};
  return base::Error{IsFull(why) ? ErrorCode::kStoreFull : ErrorCode::kFileUnwritable,
                     path.string() + ": cannot be synced; check the disk"};
}

/// "2026-11-25T023221.123Z", so that names sort by time.
std::string StampText(std::int64_t now_ms) {
  const std::chrono::sys_time<std::chrono::milliseconds> now{std::chrono::milliseconds(now_ms)};
  const auto day = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss time{now - day};
  char text[40];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d%02d%02d.%03dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                static_cast<int>(time.seconds().count()), static_cast<int>(time.subseconds().count()));
  return text;
}

void DropOldBackups(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    if (entry.path().extension() == ".sqlite") files.push_back(entry.path());
  }
  std::sort(files.rbegin(), files.rend());
  for (std::size_t i = kKeptBackups; i < files.size(); ++i) {
    fs::remove(files[i], failure);
    fs::remove(files[i].string() + ".sha256", failure);
  }
}

}  // namespace

base::Result<fs::path> BackUp(Store& store, const Viewer& viewer, fs::path file) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  const std::int64_t begin_ms = NowMilliseconds();
  const bool is_own = file.empty();
  if (is_own) file = store.GetPlace().BackupFolder() / ("store-" + StampText(begin_ms) + ".sqlite");
  if (file.has_parent_path()) {
    if (auto made = MakePrivateFolder(file.parent_path()); !made.ok()) return made.error();
  }
  const host::PartialPath part(file);
  const fs::path& partial = part.Path();
  std::error_code failure;
  Database& database = store.GetDatabase();
  auto copied = database.GetDialect() == Dialect::kSqlite ? BackUpSqlite(database, partial.string())
                                                          : BackUpPostgres(database, partial);
  if (copied.ok()) copied = SyncFile(partial);
  if (!copied.ok()) return copied.error();
  const auto hash = host::CalcSha256OfFile(partial);
  if (!hash.ok()) return hash.error();
  if (auto written =
          WritePrivateFile(file.string() + ".sha256", *hash + "  " + file.filename().string() + "\n");
      !written.ok())
    return written.error();
  fs::rename(partial, file, failure);
  if (failure)
    return base::Error{ErrorCode::kFileUnwritable,
                       file.string() + ": " + failure.message() + "; check its rights"};
  if (auto sound = VerifyBackup(file); !sound.ok()) return sound.error();
  if (is_own) {
    Spool(store.GetPlace()).ForgetJournal(begin_ms);
    DropOldBackups(store.GetPlace().BackupFolder());
  } else {
    const fs::path absolute = fs::absolute(file, failure);
    const auto noted = database.Run(
        "INSERT INTO backup (path, made_ms) VALUES ($1, $2) ON CONFLICT (path) DO UPDATE SET made_ms = "
        "excluded.made_ms",
        {absolute.string(), begin_ms});
    if (!noted.ok()) return noted.error();
  }
  return file;
}

base::Status VerifyBackup(const fs::path& file) {
  const auto line = host::ReadFile(file.string() + ".sha256", 4096);
  if (!line.ok()) return line.error();
  const auto hash = host::CalcSha256OfFile(file);
  if (!hash.ok()) return hash.error();
  if (line->substr(0, line->find(' ')) != *hash)
    return base::Error{ErrorCode::kStoreDamaged,
                       file.string() + ": the backup is not what its checksum says; take another one"};
  auto database = OpenSqlite(file.string(), 2, SqliteUse::kLook);
  if (!database.ok()) return database.error();
  const auto version = ReadSchemaVersion(**database);
  if (!version.ok()) return version.error();
  if (*version < 1 || *version > Migrations().back().version)
    return base::Error{ErrorCode::kStoreSchema, file.string() + ": of another version; use a newer program"};
  return CheckSqlite(**database);
}

base::Status Verify(Store& store) {
  Database& database = store.GetDatabase();
  if (database.GetDialect() == Dialect::kSqlite) {
    if (auto sound = CheckSqlite(database); !sound.ok()) return sound;
  }
  return InTransaction(database, Access::kRead, [&]() -> base::Status {
    const auto wrong = database.RunLong(
        "SELECT (SELECT COUNT(*) FROM (SELECT attempt.task, attempt.level, metric.metric, metric.hand, "
        "attempt.person_id, COUNT(*) AS attempts, MIN(metric.value) AS lowest, MAX(metric.value) AS highest "
        "FROM "
        "metric JOIN attempt ON attempt.id = metric.attempt_id WHERE " TROCAR_COUNTS
        " AND "
        "attempt.person_id IS "
        "NOT NULL AND metric.phase = '' AND metric.tool = '' GROUP BY attempt.task, attempt.level, "
        "metric.metric, "
        "metric.hand, attempt.person_id) counted LEFT JOIN standing ON standing.task = counted.task AND "
        "standing.level = counted.level AND standing.metric = counted.metric AND standing.hand = "
        "counted.hand AND "
        "standing.person_id = counted.person_id WHERE standing.attempts IS NULL OR standing.attempts <> "
        "counted.attempts OR standing.lowest <> counted.lowest OR standing.highest <> counted.highest), "
        "(SELECT COUNT(*) FROM standing WHERE NOT EXISTS (SELECT 1 FROM attempt WHERE attempt.person_id = "
        "standing.person_id AND attempt.task = standing.task AND attempt.level = standing.level "
        "AND " TROCAR_COUNTS "))");
    if (!wrong.ok()) return wrong.error();
    const std::int64_t count = wrong->rows[0].Int(0) + wrong->rows[0].Int(1);
    if (count == 0) return {};
    return base::Error{ErrorCode::kStoreDamaged,
                       std::to_string(count) + " standings are not what the attempts say; restore a backup"};
  });
}

}  // namespace trocar::store
