// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/store.h"

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include "database.h"
#include "private_file.h"
#include "schema.h"
#include "sql.h"
#include "tables.h"
#include "trocar/host/file_lock.h"
#include "trocar/host/log.h"
#include "trocar/host/partial_path.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/spool.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;

/// A larger store is looked at whole only by `verify` and `tidy`: a minute at each start would be too long.
constexpr std::uintmax_t kCheckedBytes = 64u << 20;

bool IsEmptyFolder(const fs::path& folder) {
  std::error_code failure;
  const bool is_empty = fs::is_empty(folder, failure);
  return failure || is_empty;
}

/// Lies in the folder of a place whose file was a store once.
fs::path MarkerOf(const Place& place) {
  return place.folder / "store";
}

/// Whether a file is a store that was damaged, and not something else that was named by mistake.
bool WasStore(const Place& place) {
  std::error_code failure;
  return fs::exists(MarkerOf(place), failure);
}

base::Status LookAtTables(Database& database) {
  for (const Table& table : Tables()) {
    const auto answer = database.Run("SELECT 1 FROM " + std::string(table.name) + " LIMIT 1");
    if (!answer.ok()) return answer.error();
  }
  return {};
}

/// The newest backup that is whole; empty where there is none.
fs::path FindBackup(const Place& place) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(place.BackupFolder(), failure)) {
    if (entry.path().extension() == ".sqlite") files.push_back(entry.path());
  }
  std::sort(files.rbegin(), files.rend());  // their names are their dates
  for (const fs::path& file : files) {
    if (VerifyBackup(file).ok()) return file;
  }
  return {};
}

}  // namespace

std::string_view RoleName(Role role) noexcept {
  static constexpr std::string_view kNames[] = {"trainee", "instructor", "administrator"};
  return kNames[static_cast<std::size_t>(role)];
}

base::Result<Role> ParseRole(std::string_view name) {
  for (const Role role : {Role::kTrainee, Role::kInstructor, Role::kAdministrator}) {
    if (RoleName(role) == name) return role;
  }
  return base::Error{ErrorCode::kUsage, "a role is trainee, instructor or administrator"};
}

Store::Store(Place place, std::unique_ptr<Database> database)
    : place_(std::move(place)), database_(std::move(database)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

base::Result<int> Store::ReadVersion() {
  return ReadSchemaVersion(*database_);
}

base::Result<Store> Store::OpenSound(const Place& place, const StoreSettings& settings) {
  std::error_code failure;
  if (!place.IsPostgres() && settings.only_look && !fs::exists(place.url, failure))
    return base::Error{ErrorCode::kStoreAway,
                       place.url + ": there is no store; trocar store migrate makes one"};
  auto database = place.IsPostgres() ? OpenPostgres(place.url, settings.busy_seconds, settings.answer_seconds)
                                     : OpenSqlite(place.url, settings.busy_seconds);
  if (!database.ok()) return database.error();
  const auto version = ReadSchemaVersion(**database);
  if (!version.ok()) return version.error();
  const int newest = Migrations().back().version;
  if (*version != newest) {
    if (settings.only_look && *version < newest)
      return base::Error{ErrorCode::kStoreSchema, "the store is of version " + std::to_string(*version) +
                                                      "; trocar store migrate brings it to version " +
                                                      std::to_string(newest)};
    if (auto migrated = Migrate(**database, Migrations()); !migrated.ok()) return migrated.error();
  }
  if (!place.IsPostgres()) {
    const auto bytes = fs::file_size(place.url, failure);
    const auto sound =
        !failure && bytes <= kCheckedBytes ? CheckSqlite(**database) : LookAtTables(**database);
    if (!sound.ok()) return sound.error();
    // without it the store is as good; only a damaged first page would not be known for what it was
    if (!settings.only_look && !fs::exists(MarkerOf(place), failure))
      (void)WritePrivateFile(MarkerOf(place), place.url + "\n").ok();
  }
  return Store(place, std::move(*database));
}

base::Status EraseRemnants(const Place& place) {
  std::vector<fs::path> folders = {place.folder, place.SpoolFolder(), place.JournalFolder(),
                                   place.BackupFolder()};
  for (const char* name : {"held", "damaged", "unmeasured"}) folders.push_back(place.SpoolFolder() / name);
  for (const fs::path& folder : folders) {
    if (auto gone = EraseRemnants(folder); !gone.ok()) return gone;
  }
  // the names as they were before their last change: another name of the same file, or a file of its own
  std::error_code failure;
  const fs::path old = place.NamesFile().string() + ".old";
  if (!fs::exists(old, failure)) return {};
  const auto lock = host::FileLock::Take(place.NamesFile().string() + ".lock");
  if (!lock.ok()) return {};  // somebody is at it
  if (!fs::equivalent(old, place.NamesFile(), failure)) return EraseFile(old);
  fs::remove(old, failure);
  return {};
}

base::Result<Store> Store::Open(const Place& place, const StoreSettings& settings) {
  if (!settings.only_look) {
    // what is left of a program that was killed hinders nobody; who erases a person hears of it
    if (auto gone = EraseRemnants(place); !gone.ok())
      host::Log(host::LogLevel::kWarning, gone.error().Text());
  }
  if (place.IsPostgres()) return OpenSound(place, settings);
  std::error_code failure;
  const bool is_gone = !fs::exists(place.url, failure) &&
                       (!IsEmptyFolder(place.BackupFolder()) || !IsEmptyFolder(place.JournalFolder()));
  if (is_gone && !settings.only_look) return Rebuild(place, settings, "was gone");
  auto store = OpenSound(place, settings);
  if (store.ok() || store.error().code != ErrorCode::kStoreDamaged) return store;
  if (!WasStore(place))
    return base::Error{ErrorCode::kStoreSchema,
                       place.url +
                           ": this file is no store, or one that was damaged before it was ever opened here; "
                           "name another file, or restore a backup"};
  if (settings.only_look) return store;
  return Rebuild(place, settings, "was damaged");
}

base::Result<Store> Store::Rebuild(const Place& place, const StoreSettings& settings,
                                   const std::string& why) {
  const auto lock = host::FileLock::Take(place.folder / "rebuild.lock");
  if (!lock.ok()) {
    if (lock.error().code != ErrorCode::kFileInUse) return lock.error();
    return base::Error{ErrorCode::kStoreBusy, place.url + ": another program builds the store again (" +
                                                  lock.error().message + "); try again when it is done"};
  }
  std::error_code failure;
  // another program may have done it while this one came here
  if (fs::exists(place.url, failure)) {
    auto store = OpenSound(place, settings);
    if (store.ok() || store.error().code != ErrorCode::kStoreDamaged) return store;
  }
  std::string report = "the store " + why;
  const std::string stamp = std::to_string(NowMilliseconds());
  for (const char* part : {"", "-wal", "-shm"}) {
    if (!fs::exists(place.url + part, failure)) continue;
    const std::string aside = place.url + ".damaged-" + stamp + part;
    fs::rename(place.url + part, aside, failure);
    if (failure)
      return base::Error{ErrorCode::kStoreReadOnly, place.url +
                                                        ": cannot be set aside: " + failure.message() +
                                                        "; give yourself the right to write its folder"};
    if (*part == '\0') report += " and is set aside as " + aside;
  }
  const fs::path backup = FindBackup(place);
  if (!backup.empty()) {
    const host::PartialPath part(place.url);
    const fs::path& partial = part.Path();
    fs::copy_file(backup, partial, fs::copy_options::overwrite_existing, failure);
    if (!failure) fs::permissions(partial, fs::perms::owner_read | fs::perms::owner_write, failure);
    if (!failure) fs::rename(partial, place.url, failure);
    if (failure)
      return base::Error{ErrorCode::kStoreFull, place.url +
                                                    ": the backup cannot be copied: " + failure.message() +
                                                    "; check the space left and the rights"};
  }
  auto store = OpenSound(place, settings);
  if (!store.ok()) return store;
  const Spool spool(place);
  const DeliveryReport journal = spool.DeliverJournal(*store);
  if (journal.failure) return *journal.failure;
  report += backup.empty() ? "; there was no backup: groups, courses and roles must be entered again"
                           : "; built again from the backup " + backup.string();
  report += ", with " + std::to_string(journal.added) + " attempts that came after it";
  if (journal.damaged > 0)
    report += "; " + std::to_string(journal.damaged) + " attempts of its journal are damaged";
  store->rebuilt_ = report;
  return store;
}

}  // namespace trocar::store
