// SPDX-License-Identifier: Apache-2.0
// One SQL text for two databases: statements with $1, $2, ... and rows of plain values.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::store {

enum class Dialect : std::uint8_t { kSqlite, kPostgres };

/// Null, a whole number, a number or a text.
using Value = std::variant<std::monostate, std::int64_t, double, std::string>;
using Parameters = std::vector<Value>;

template <typename T>
Value OrNull(const std::optional<T>& value) {
  if (!value) return std::monostate{};
  if constexpr (std::is_same_v<T, bool>)
    return std::int64_t{*value};
  else
    return Value(*value);
}

/// One row of an answer. Asking for another kind than the column has is our bug (TROCAR_ASSERT).
struct Row {
  std::vector<Value> values;

  bool IsNull(std::size_t column) const { return values[column].index() == 0; }
  std::int64_t Int(std::size_t column) const;
  double Real(std::size_t column) const;
  const std::string& Text(std::size_t column) const;
  std::optional<double> RealOrNull(std::size_t column) const;
  std::optional<std::int64_t> IntOrNull(std::size_t column) const;
};

struct Answer {
  std::vector<Row> rows;
  std::int64_t changed = 0;  ///< rows that were inserted, changed or deleted
};

enum class Access : std::uint8_t { kRead, kWrite };

/// A connection. Errors are of kStore...; a connection that was lost stays lost.
class Database {
 public:
  virtual ~Database() = default;
  /// One statement. Texts may hold any bytes.
  virtual base::Result<Answer> Run(std::string_view sql, const Parameters& parameters = {}) = 0;
  /// One that may read whole tables: no limit of time.
  virtual base::Result<Answer> RunLong(std::string_view sql, const Parameters& parameters = {}) = 0;
  /// Statements apart by ";\n", without parameters.
  virtual base::Status RunScript(std::string_view sql) = 0;
  /// \param access  kWrite waits for other writers at once; kRead sees one moment until Commit
  virtual base::Status Begin(Access access) = 0;
  virtual base::Status Commit() = 0;
  virtual void Rollback() = 0;
  virtual Dialect GetDialect() const = 0;
  virtual bool IsInTransaction() const = 0;
  /// Gives deleted rows' bytes back, so that they are in no file of the database.
  virtual base::Status Purge() = 0;
};

/// Runs `work` in one transaction: all of it is kept, or nothing.
template <typename Work>
auto InTransaction(Database& database, Access access, const Work& work) -> decltype(work()) {
  if (database.IsInTransaction()) return work();
  if (auto begun = database.Begin(access); !begun.ok()) return begun.error();
  auto result = work();
  if (!result.ok()) {
    database.Rollback();
    return result;
  }
  if (auto kept = database.Commit(); !kept.ok()) return kept.error();
  return result;
}

/// Text that no database refuses: what is no UTF-8, holds NUL or begins with U+0001 is written with escapes behind a U+0001.
std::string EncodeText(std::string_view text);
/// Inverse of EncodeText.
std::string DecodeText(std::string_view text);

enum class SqliteUse : std::uint8_t {
  kStore,  ///< made where it is missing
  kLook    ///< not a byte of it changes
};

/// A SQLite file. \param busy_seconds  how long it waits for another writer [s]
base::Result<std::unique_ptr<Database>> OpenSqlite(const std::string& path, double busy_seconds,
                                                   SqliteUse use = SqliteUse::kStore);
/// \param answer_seconds  a server that does not answer for so long counts as away [s]
base::Result<std::unique_ptr<Database>> OpenPostgres(const std::string& url, double busy_seconds,
                                                     double answer_seconds);

/// Copies a SQLite store, also while others write, to a new file.
base::Status BackUpSqlite(Database& database, const std::string& to);
/// Whether every page and index of a SQLite database is sound. \return kStoreDamaged with the first complaint
base::Status CheckSqlite(Database& database);

}  // namespace trocar::store
