// SPDX-License-Identifier: Apache-2.0
// The tables, as numbered steps from an empty database to today's.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "database.h"

namespace trocar::store {

/// One step. Its text, once released, never changes. {id}, {text}, {number} and {compact} are the dialect's words;
/// a line that begins with "-- postgresql: " is for that database alone.
struct Migration {
  int version;
  std::string_view sql;
};

std::span<const Migration> Migrations() noexcept;

/// 0 of an empty database. \return kStoreSchema of one that holds other tables
base::Result<int> ReadSchemaVersion(Database& database);

/// Does all steps that are missing in one transaction, one program at a time.
/// \return the version before; kStoreSchema where the database is of a later one
base::Result<int> Migrate(Database& database, std::span<const Migration> migrations);

}  // namespace trocar::store
