// SPDX-License-Identifier: Apache-2.0
// The tables as lists of columns, for whatever goes through all of them: backup, export, import.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "database.h"

namespace trocar::store {

/// Table to whose ids a column refers.
enum class Reference : std::uint8_t { kNone, kPerson, kGroup, kCourse, kAssignment, kAttempt, kCount };

enum class ColumnKind : std::uint8_t { kText, kWhole, kNumber };

struct Column {
  std::string_view name;
  ColumnKind kind = ColumnKind::kText;
  bool may_be_null = false;
  Reference refers = Reference::kNone;
  std::optional<std::string_view> before =
      {};  ///< text of a row that was written before there was this column
};

struct Table {
  std::string_view name;
  Reference owns;        ///< whose id its first column is, or kNone
  std::string_view key;  ///< the columns that tell rows apart, with commas; empty where no row is looked for
  std::string_view
      page;  ///< the whole number by which it is read in parts; empty: small enough to be read at once
  std::vector<Column> columns;
};

/// All tables that hold rows, those that others refer to first.
std::span<const Table> Tables();

/// Reads a table in parts. \param take  gets each row, in the order of the columns
base::Status ForEachRow(Database& database, const Table& table,
                        const std::function<base::Status(const Row&)>& take);

/// "INSERT INTO table (a, b) VALUES ($1, $2)".
std::string InsertText(const Table& table, bool with_own_id);

}  // namespace trocar::store
