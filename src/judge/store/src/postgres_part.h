// SPDX-License-Identifier: Apache-2.0
/// \file postgres_part.h  The border of trocar-postgres.so, which is loaded when a store on a PostgreSQL server is opened.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "database.h"

namespace trocar::store {

using OpenedDatabase = base::Result<std::unique_ptr<Database>>;

/// The one function that the part exports: OpenPostgres(), with its result in `opened`.
using PostgresEntry = void(const std::string& url, double busy_seconds, double answer_seconds,
                           OpenedDatabase& opened);
inline constexpr const char* kPostgresEntry = "TrocarOpenPostgres";

/// OpenPostgres() by the part in this file.
/// \return also kFileMissing or kFileUnreadable of the part, with what to do
OpenedDatabase OpenPostgresBy(const std::filesystem::path& part, const std::string& url, double busy_seconds,
                              double answer_seconds);

}  // namespace trocar::store
