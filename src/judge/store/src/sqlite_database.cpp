// SPDX-License-Identifier: Apache-2.0
// SQLite: write-ahead log, every commit synced, deleted bytes overwritten.
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>
#include <unordered_map>
#include <utility>

#include "database.h"
#include "private_file.h"
#include "trocar/host/clock.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

struct CloseConnection {
  void operator()(sqlite3* connection) const { ::sqlite3_close_v2(connection); }
};
using Connection = std::unique_ptr<sqlite3, CloseConnection>;

struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { ::sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, CloseStatement>;

constexpr std::size_t kMostStatements = 200;  // kept prepared

/// Whether a disk can take no more: SQLite says so of its writes alone, not of its log's index, a new file or a folder.
bool IsDiskFull(const std::string& path, int system_error) {
  if (IsFull(system_error)) return true;
  struct statvfs disk {};
  const fs::path folder = fs::path(path).parent_path();
  if (::statvfs(folder.empty() ? "." : folder.c_str(), &disk) != 0) return false;
  return disk.f_bavail == 0 || (disk.f_files > 0 && disk.f_favail == 0);
}

/// \param system_error  errno, where it is known
base::Error MakeError(int extended, const std::string& path, int system_error = 0) {
  const std::string why = path + ": " + ::sqlite3_errstr(extended);
  const int primary = extended & 0xFF;
  const bool may_be_full = primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN;
  if (may_be_full && extended != SQLITE_IOERR_READ && IsDiskFull(path, system_error))
    return {ErrorCode::kStoreFull, why + "; the disk is full: free space on it. Attempts wait in the spool"};
  switch (extended & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorCode::kStoreBusy, why +
                                         "; another program writes the store: try again, or end that "
                                         "program. Attempts wait in the spool"};
    case SQLITE_FULL:
      return {ErrorCode::kStoreFull, why + "; free space on that disk. Attempts wait in the spool"};
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return {ErrorCode::kStoreDamaged,
              why + "; open the store once more: it is set aside and built again from its last backup"};
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return {ErrorCode::kStoreReadOnly, why + "; give yourself the right to write the file and its folder"};
    case SQLITE_IOERR:
      if (extended == SQLITE_IOERR_WRITE || extended == SQLITE_IOERR_FSYNC)
        return {ErrorCode::kStoreFull,
                why + "; check the disk and the space left on it. Attempts wait in the spool"};
      return {ErrorCode::kStoreAway, why + "; check the disk that the store lies on"};
    case SQLITE_CANTOPEN:
      return {ErrorCode::kStoreAway, why + "; check the path and its rights"};
    case SQLITE_CONSTRAINT:
      return {ErrorCode::kStoreInvalid, why + "; what shall be stored contradicts what is there"};
    case SQLITE_ERROR:
      return {ErrorCode::kStoreSchema,
              why + "; the tables are not those of a store: name another file, or restore a backup"};
    default:
      return {ErrorCode::kStoreAway, why + "; check the disk that the store lies on"};
  }
}

/// Asks again every millisecond or so. SQLite's own pauses grow to 100 ms, in which a busy writer never lets another one in.
struct Patience {
  double seconds = 0;
  host::Stopwatch watch;

  static int Wait(void* self, int tries) {
    auto& patience = *static_cast<Patience*>(self);
    if (tries == 0) patience.watch.Restart();
    if (patience.watch.Seconds() > patience.seconds) return 0;
    std::this_thread::sleep_for(std::chrono::microseconds(300 + 211 * (tries % 5)));
    return 1;
  }
};

class SqliteDatabase final : public Database {
 public:
  SqliteDatabase(Connection connection, std::string path, double busy_seconds)
      : connection_(std::move(connection)), path_(std::move(path)) {
    patience_.seconds = busy_seconds;
    ::sqlite3_busy_handler(connection_.get(), Patience::Wait, &patience_);
  }
  ~SqliteDatabase() override { statements_.clear(); }

  sqlite3* Handle() { return connection_.get(); }
  const std::string& Path() const { return path_; }
  Dialect GetDialect() const override { return Dialect::kSqlite; }
  bool IsInTransaction() const override { return ::sqlite3_get_autocommit(connection_.get()) == 0; }

  base::Result<Answer> Run(std::string_view sql, const Parameters& parameters) override {
    auto prepared = Prepare(sql);
    if (!prepared.ok()) return prepared.error();
    sqlite3_stmt* statement = *prepared;
    for (std::size_t i = 0; i < parameters.size(); ++i) Bind(statement, i, parameters[i]);
    Answer answer;
    int code = SQLITE_OK;
    while ((code = ::sqlite3_step(statement)) == SQLITE_ROW) answer.rows.push_back(ReadRow(statement));
    ::sqlite3_reset(statement);
    ::sqlite3_clear_bindings(statement);
    if (code != SQLITE_DONE) return Failure();
    answer.changed = ::sqlite3_changes64(connection_.get());
    return answer;
  }

  base::Result<Answer> RunLong(std::string_view sql, const Parameters& parameters) override {
    return Run(sql, parameters);
  }

  base::Status RunScript(std::string_view sql) override {
    if (::sqlite3_exec(connection_.get(), std::string(sql).c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
      return Failure();
    return {};
  }

  base::Status Begin(Access access) override {
    if (access == Access::kRead) return RunScript("BEGIN DEFERRED");
    // a file that somebody deleted or exchanged would swallow what is written
    int is_moved = 0;
    ::sqlite3_file_control(connection_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &is_moved);
    if (is_moved != 0)
      return base::Error{
          ErrorCode::kStoreAway,
          path_ +
              ": the file was moved or deleted while it was open; put it back, or open the store "
              "again: it is built again from its last backup"};
    return RunScript("BEGIN IMMEDIATE");
  }
  base::Status Commit() override {
    if (auto status = RunScript("COMMIT"); !status.ok()) {
      Rollback();
      return status;
    }
    return {};
  }
  void Rollback() override {
    if (IsInTransaction()) ::sqlite3_exec(connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
  }

  base::Status Purge() override {
    statements_.clear();  // an open statement would hold old pages of the log
    for (const char* step : {"VACUUM", "PRAGMA wal_checkpoint(TRUNCATE)"}) {
      auto answer = Run(step, {});
      statements_.clear();
      if (!answer.ok()) return answer.error();
      // the checkpoint's first column: 1 where a reader was in the way
      if (!answer->rows.empty() && answer->rows[0].Int(0) != 0)
        return base::Error{
            ErrorCode::kStoreBusy,
            path_ +
                ": another program reads the store, so that deleted bytes are still in its log; "
                "end that program and run trocar store tidy"};
    }
    return {};
  }

 private:
  base::Error Failure() {
    return MakeError(::sqlite3_extended_errcode(connection_.get()), path_,
                     ::sqlite3_system_errno(connection_.get()));
  }

  base::Result<sqlite3_stmt*> Prepare(std::string_view sql) {
    std::string key(sql);
    if (const auto found = statements_.find(key); found != statements_.end()) return found->second.get();
    if (statements_.size() >= kMostStatements) statements_.clear();
    sqlite3_stmt* statement = nullptr;
    if (::sqlite3_prepare_v3(connection_.get(), sql.data(), static_cast<int>(sql.size()),
                             SQLITE_PREPARE_PERSISTENT, &statement, nullptr) != SQLITE_OK)
      return Failure();
    statements_.emplace(std::move(key), Statement(statement));
    return statement;
  }

  /// $3 is a name to SQLite, numbered by its first occurrence.
  static void Bind(sqlite3_stmt* statement, std::size_t i, const Value& value) {
    const int place = ::sqlite3_bind_parameter_index(statement, ("$" + std::to_string(i + 1)).c_str());
    TROCAR_ASSERT(place > 0);
    if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      ::sqlite3_bind_int64(statement, place, *whole);
    } else if (const auto* real = std::get_if<double>(&value)) {
      ::sqlite3_bind_double(statement, place, *real);
    } else if (const auto* text = std::get_if<std::string>(&value)) {
      const std::string encoded = EncodeText(*text);
      ::sqlite3_bind_text64(statement, place, encoded.data(), encoded.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
    } else {
      ::sqlite3_bind_null(statement, place);
    }
  }

  static Row ReadRow(sqlite3_stmt* statement) {
    Row row;
    const int columns = ::sqlite3_column_count(statement);
    row.values.reserve(static_cast<std::size_t>(columns));
    for (int c = 0; c < columns; ++c) {
      switch (::sqlite3_column_type(statement, c)) {
        case SQLITE_INTEGER:
          row.values.emplace_back(static_cast<std::int64_t>(::sqlite3_column_int64(statement, c)));
          break;
        case SQLITE_FLOAT:
          row.values.emplace_back(::sqlite3_column_double(statement, c));
          break;
        case SQLITE_NULL:
          row.values.emplace_back(std::monostate{});
          break;
        default: {
          const auto* text = reinterpret_cast<const char*>(::sqlite3_column_text(statement, c));
          const auto size = static_cast<std::size_t>(::sqlite3_column_bytes(statement, c));
          row.values.emplace_back(DecodeText({text, size}));
        }
      }
    }
    return row;
  }

  Patience patience_;
  Connection connection_;
  std::string path_;
  std::unordered_map<std::string, Statement> statements_;  // destroyed before the connection
};

/// Only its owner may read a store; SQLite gives its log the same rights.
base::Status MakePrivateFile(const std::string& path) {
  std::error_code failure;
  if (const fs::path folder = fs::path(path).parent_path(); !folder.empty()) {
    if (auto made = MakePrivateFolder(folder); !made.ok() && made.error().code == ErrorCode::kStoreFull)
      return made;
  }
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) {
    if (errno == EACCES && fs::exists(path, failure)) return {};  // may be readable; SQLite says what it can
    return base::Error{IsFull(errno)                       ? ErrorCode::kStoreFull
                       : errno == EROFS || errno == EACCES ? ErrorCode::kStoreReadOnly
                                                           : ErrorCode::kStoreAway,
                       path + ": " + std::strerror(errno) + "; check the path and its rights"};
  }
  ::close(file);
  return {};
}

}  // namespace

base::Result<std::unique_ptr<Database>> OpenSqlite(const std::string& path, double busy_seconds,
                                                   SqliteUse use) {
  const bool is_look = use == SqliteUse::kLook;
  if (!is_look) {
    if (auto made = MakePrivateFile(path); !made.ok()) return made.error();
  }
  sqlite3* raw = nullptr;
  const int flags = is_look ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  const int code = ::sqlite3_open_v2(path.c_str(), &raw, flags | SQLITE_OPEN_FULLMUTEX, nullptr);
  Connection connection(raw);
  if (code != SQLITE_OK) return MakeError(code, path, ::sqlite3_system_errno(raw));
  ::sqlite3_extended_result_codes(raw, 1);
  auto database = std::make_unique<SqliteDatabase>(std::move(connection), path, busy_seconds);
  // no temporary files: people's rows would lie outside of the store's folder
  if (auto set = database->RunScript("PRAGMA trusted_schema=OFF; PRAGMA foreign_keys=ON; PRAGMA "
                                     "secure_delete=ON; PRAGMA cache_size=-65536; PRAGMA temp_store=MEMORY");
      !set.ok())
    return set.error();
  if (is_look) return std::unique_ptr<Database>(std::move(database));
  if (::sqlite3_db_readonly(raw, "main") != 0) {
    // its log may need a file that cannot be made
    if (const auto seen = database->Run("SELECT COUNT(*) FROM sqlite_schema", {}); !seen.ok())
      return base::Error{
          ErrorCode::kStoreReadOnly,
          path +
              ": the store can be neither written nor read without the right to write; give yourself "
              "the right to write the file and its folder"};
    return std::unique_ptr<Database>(std::move(database));
  }
  // two programs that make the same store: SQLite does not wait by itself for this change
  const host::Stopwatch watch;
  while (true) {
    const auto set = database->RunScript("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL");
    if (set.ok()) break;
    if (set.error().code != ErrorCode::kStoreBusy || watch.Seconds() > busy_seconds) return set.error();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return std::unique_ptr<Database>(std::move(database));
}

base::Status BackUpSqlite(Database& database, const std::string& to) {
  auto& from = static_cast<SqliteDatabase&>(database);
  if (auto made = MakePrivateFile(to); !made.ok()) return made;
  sqlite3* raw = nullptr;
  const int code = ::sqlite3_open_v2(to.c_str(), &raw, SQLITE_OPEN_READWRITE, nullptr);
  const Connection target(raw);
  if (code != SQLITE_OK) return MakeError(code, to, ::sqlite3_system_errno(raw));
  sqlite3_backup* backup = ::sqlite3_backup_init(raw, "main", from.Handle(), "main");
  if (backup == nullptr) return MakeError(::sqlite3_extended_errcode(raw), to, ::sqlite3_system_errno(raw));
  // in one step: a backup of many steps begins again whenever another program writes between them
  const int copied = ::sqlite3_backup_step(backup, -1);
  const int finished = ::sqlite3_backup_finish(backup);
  if (copied != SQLITE_DONE) return MakeError(copied, to, ::sqlite3_system_errno(raw));
  if (finished != SQLITE_OK) return MakeError(finished, to, ::sqlite3_system_errno(raw));
  // one file, without a log beside it
  if (::sqlite3_exec(raw, "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr) != SQLITE_OK)
    return MakeError(::sqlite3_extended_errcode(raw), to, ::sqlite3_system_errno(raw));
  return {};
}

base::Status CheckSqlite(Database& database) {
  auto answer = database.Run("PRAGMA integrity_check(1)");
  if (!answer.ok()) return answer.error();
  const std::string& path = static_cast<SqliteDatabase&>(database).Path();
  if (answer->rows.size() == 1 && answer->rows[0].Text(0) == "ok") {
    answer = database.Run("PRAGMA foreign_key_check");
    if (!answer.ok()) return answer.error();
    if (answer->rows.empty()) return {};
    return base::Error{ErrorCode::kStoreDamaged, path + ": a row of " + answer->rows[0].Text(0) +
                                                     " belongs to nothing; restore a backup"};
  }
  return base::Error{ErrorCode::kStoreDamaged,
                     path + ": " +
                         (answer->rows.empty() ? std::string("no answer") : answer->rows[0].Text(0)) +
                         "; open the store once more: it is set aside and built again from its last backup"};
}

}  // namespace trocar::store
