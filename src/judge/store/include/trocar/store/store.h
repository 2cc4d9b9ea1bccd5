// SPDX-License-Identifier: Apache-2.0
/// \file store.h  The memory of a training centre: a SQLite file of one's own, or a PostgreSQL database that a centre shares, with
/// the same tables. docs/store.md explains it. Nothing here belongs on a real-time thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::store {

class Database;

/// Role of a person, which decides their access rights.
/// Trainee: own attempts, courses and certificates, and how they compare with a group of their own.
/// Instructor: the same of every member of the groups that they belong to; remarks, ratings, assignments.
/// Administrator: everything.
enum class Role : std::uint8_t { kTrainee, kInstructor, kAdministrator };

/// "trainee", "instructor", "administrator".
std::string_view RoleName(Role role) noexcept;
/// \return kUsage for another word
base::Result<Role> ParseRole(std::string_view name);

/// Person who makes a request. Every function that shows or changes something takes one, and refuses with kStoreRefused.
struct Viewer {
  std::int64_t person = 0;  ///< 0: nobody that the store knows
  Role role = Role::kTrainee;

  /// Whoever holds the file or the database's account: may do everything.
  static Viewer Owner() { return {0, Role::kAdministrator}; }
};

/// Where a store lies, and the folder of what belongs to it on this computer.
struct Place {
  std::string url;               ///< path of a SQLite file, or "postgresql://..."
  std::filesystem::path folder;  ///< names, spool, journal, backups

  bool IsPostgres() const;
  /// Pseudonyms and who they are; only their owner may read it.
  std::filesystem::path NamesFile() const { return folder / "names.json"; }
  /// Attempts that wait for the store.
  std::filesystem::path SpoolFolder() const { return folder / "spool"; }
  /// Attempts that arrived after the last backup.
  std::filesystem::path JournalFolder() const { return folder / "journal"; }
  std::filesystem::path BackupFolder() const { return folder / "backups"; }
  /// The URL without its password, for messages.
  std::string Text() const;
};

/// \param url  as of Place; empty: TROCAR_STORE, else store/store.sqlite in host::FindUserDataFolder()
/// \return kUsage for anything else, such as a mistyped scheme or libpq's keywords; the message never holds the text
base::Result<Place> FindPlace(std::string url = {});

struct StoreSettings {
  double busy_seconds = 2;     ///< how long it waits for another writer [s]
  double answer_seconds = 10;  ///< a server that is silent for longer counts as away [s], >= 2
  /// Does not make a store, change its tables or build a damaged one again.
  bool only_look = false;
};

/// An open store. One thread at a time.
class Store {
 public:
  /// Makes the store where there is none, and brings an older one's tables up to date. A SQLite file that is damaged, or gone while
  /// there are backups or a journal, is set aside and built again from them: Rebuilt() says so.
  /// \return kStoreBusy, kStoreFull, kStoreAway, kStoreSchema, kStoreReadOnly; kStoreDamaged where only_look
  static base::Result<Store> Open(const Place& place, const StoreSettings& settings = {});
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  const Place& GetPlace() const { return place_; }
  /// Report on the repair of a damaged store, for a person; empty where nothing was wrong.
  const std::string& Rebuilt() const { return rebuilt_; }
  /// Of the tables.
  base::Result<int> ReadVersion();

  /// For the functions of this module.
  Database& GetDatabase() { return *database_; }

 private:
  Store(Place place, std::unique_ptr<Database> database);
  static base::Result<Store> OpenSound(const Place& place, const StoreSettings& settings);
  static base::Result<Store> Rebuild(const Place& place, const StoreSettings& settings,
                                     const std::string& why);

  Place place_;
  std::unique_ptr<Database> database_;
  std::string rebuilt_;
};

}  // namespace trocar::store
