// SPDX-License-Identifier: Apache-2.0
// Export and import, row by row.
#include <array>
#include <charconv>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "attempt_rows.h"
#include "database.h"
#include "private_file.h"
#include "schema.h"
#include "sql.h"
#include "tables.h"
#include "trocar/host/csv_field.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/store/attempts.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/people.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using nlohmann::ordered_json;

/// Any number of rows; a course, a certificate or a remark may be long, with an escape for each of its letters.
constexpr host::JsonLimits kExportLimits{0, 6, std::numeric_limits<std::size_t>::max(), 100, 16u << 20};

ordered_json JsonOf(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return *whole;
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* text = std::get_if<std::string>(&value)) return EncodeText(*text);
  return nullptr;
}

base::Error BadRow(const Table& table, const std::string& what) {
  return {ErrorCode::kJsonField,
          "in the export, at a row of " + std::string(table.name) + ": " + what + "; export it again"};
}

/// Takes rows of another store, in the order of Tables().
class RowImporter {
 public:
  RowImporter(Database& database, Trust trust) : database_(database), trust_(trust) {}

  base::Status Take(const Table& table, const std::vector<Value>& row) {
    Parameters values;
    std::int64_t old_id = 0, attempt = 0;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Column& column = table.columns[c];
      Value value = row[c];
      if (value.index() == 0 && column.before) value = std::string(*column.before);
      if (auto sound = CheckKind(table, column, value); !sound.ok()) return sound;
      if (column.name == "outcome") {
        if (auto sound = CheckOutcome(std::get<std::string>(value)); !sound.ok()) return sound;
      }
      if (column.name == "id") {
        old_id = std::get<std::int64_t>(value);
        continue;
      }
      if (column.refers != Reference::kNone && value.index() != 0) {
        const auto& ids = ids_[static_cast<std::size_t>(column.refers)];
        const auto found = ids.find(std::get<std::int64_t>(value));
        if (found == ids.end()) {
          // dates of an assignment that was there already stay what they are
          if (column.refers == Reference::kAssignment) return {};
          return BadRow(table, std::string(column.name) + " is the id of nothing");
        }
        if (column.refers == Reference::kAttempt) attempt = found->second;
        value = found->second;
      }
      values.push_back(std::move(value));
    }
    // what belongs to an attempt that was there is there, too; ratings may have come later
    const bool is_rating = table.name == "rating";
    if (attempt != 0 && !is_rating && new_attempts_.count(attempt) == 0) return {};
    if (table.owns == Reference::kPerson) {
      if (auto sound = CheckPseudonym(std::get<std::string>(values.front())); !sound.ok())
        return BadRow(table, sound.error().message);
    } else if (table.owns == Reference::kGroup) {
      if (auto sound = CheckGroupName(std::get<std::string>(values.front())); !sound.ok())
        return BadRow(table, sound.error().message);
    }
    if (table.owns == Reference::kAttempt) {
      if (auto marked = Mark(table, values); !marked.ok()) return marked;
    }
    return Insert(table, values, old_id);
  }

  base::Status Finish() {
    for (const std::int64_t person : raised_) {
      if (auto counted = RecalcStandings(database_, person); !counted.ok()) return counted;
    }
    return {};
  }

  ImportReport report;

 private:
  static base::Status CheckKind(const Table& table, const Column& column, Value& value) {
    if (value.index() == 0) {
      if (column.may_be_null) return {};
    } else if (column.kind == ColumnKind::kText) {
      if (std::holds_alternative<std::string>(value)) return {};
    } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      if (column.kind == ColumnKind::kNumber) value = static_cast<double>(*whole);
      return {};
    } else if (column.kind == ColumnKind::kNumber && std::holds_alternative<double>(value)) {
      return {};
    }
    return BadRow(table, std::string(column.name) + " is missing or of the wrong kind");
  }

  /// Anybody can write a file: what it says of an attempt's truth counts only where whoever imports it says so.
  base::Status Mark(const Table& table, Parameters& values) const {
    const auto field = [&](std::string_view name) -> Value& {
      std::size_t place = 0;
      for (const Column& column : table.columns) {
        if (column.name == name) break;
        if (column.name != "id") ++place;
      }
      return values[place];
    };
    field("due_ms") = std::monostate{};  // how long it is kept is decided here
    const auto state = ParseVerification(std::get<std::string>(field("verification")));
    if (!state || !ParseWhy(std::get<std::string>(field("verification_why"))))
      return BadRow(table, "verification or verification_why is a word that this program does not know");
    if (trust_ == Trust::kAsItSays || *state == Verification::kRefused) return {};
    field("verification") = std::string(VerificationName(Verification::kUnverified));
    field("verification_why") = std::string(WhyName(WhyUnverified::kImported));
    field("verified_by") = std::string();
    field("verified_ms") = std::monostate{};
    return {};
  }

  base::Status Insert(const Table& table, const Parameters& values, std::int64_t old_id) {
    std::string sql = InsertText(table, false) + " ON CONFLICT DO NOTHING";
    const bool owns = table.owns != Reference::kNone;
    if (owns) sql += " RETURNING id";
    const auto added = database_.Run(sql, values);
    if (!added.ok()) return added.error();
    if (!owns) return {};
    auto& ids = ids_[static_cast<std::size_t>(table.owns)];
    if (!added->rows.empty()) {
      ids[old_id] = added->rows[0].Int(0);
      Count(table, values, added->rows[0].Int(0));
      return {};
    }
    if (table.key.empty()) return {};
    return FindOwn(table, values, ids[old_id]);
  }

  /// The id of the row that was there already.
  base::Status FindOwn(const Table& table, const Parameters& values, std::int64_t& id) {
    Parameters key;
    std::string where;
    std::size_t place = 0;
    for (const Column& column : table.columns) {
      if (column.name == "id") continue;
      const std::string all = "," + std::string(table.key) + ",";
      if (all.find("," + std::string(column.name) + ",") != std::string::npos)
        where += std::string(where.empty() ? "" : " AND ") + std::string(column.name) + " = " +
                 Put(key, values[place]);
      ++place;
    }
    const bool is_course = table.owns == Reference::kCourse;
    const auto found = database_.Run(std::string("SELECT id") + (is_course ? ", content" : "") + " FROM " +
                                         std::string(table.name) + " WHERE " + where,
                                     key);
    if (!found.ok()) return found.error();
    if (found->rows.size() != 1) return BadRow(table, "it contradicts another row");
    if (is_course && found->rows[0].Text(1) != std::get<std::string>(values.back()))
      return Invalid(
          "a course of the export is in the store with another text in the same version; nothing was "
          "imported");
    id = found->rows[0].Int(0);
    if (table.owns == Reference::kAttempt) {
      ++report.known;
      const auto person = database_.Run("SELECT person_id FROM attempt WHERE id = $1", {id});
      if (!person.ok()) return person.error();
      const auto* theirs = std::get_if<std::int64_t>(&values[3]);
      if (person->rows[0].IntOrNull(0) != (theirs == nullptr ? std::nullopt : std::optional(*theirs)))
        ++report.conflicts;
    }
    return {};
  }

  void Count(const Table& table, const Parameters& values, std::int64_t id) {
    switch (table.owns) {
      case Reference::kPerson:
        ++report.people;
        break;
      case Reference::kGroup:
        ++report.groups;
        break;
      case Reference::kCourse:
        ++report.courses;
        break;
      case Reference::kAttempt:
        ++report.attempts;
        new_attempts_.insert(id);
        if (const auto* person = std::get_if<std::int64_t>(&values[3])) raised_.insert(*person);
        break;
      default:
        break;
    }
  }

  Database& database_;
  Trust trust_;
  std::array<std::unordered_map<std::int64_t, std::int64_t>, static_cast<std::size_t>(Reference::kCount)>
      ids_;
  std::unordered_set<std::int64_t> new_attempts_;
  std::set<std::int64_t> raised_;  // people whose standings change
};

/// Reads an export while it is parsed: only one row is in memory.
class ExportReader final : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit ExportReader(RowImporter& importer) : importer_(importer) {}

  base::Status Result(const std::string& path) const {
    if (failure_) return *failure_;
    if (!has_format_ || version_ != 1)
      return base::Error{
          ErrorCode::kStoreSchema,
          path + ": this is no export of a store that this program knows; use a newer program"};
    return {};
  }

  bool null() override { return Keep(std::monostate{}); }
  bool boolean(bool) override { return Fail("a truth value where none belongs"); }
  bool number_integer(number_integer_t value) override { return Keep(std::int64_t{value}); }
  bool number_unsigned(number_unsigned_t value) override { return Keep(static_cast<std::int64_t>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return Keep(value); }
  bool string(string_t& value) override { return Keep(DecodeText(value)); }
  bool binary(binary_t&) override { return Fail("bytes where none belong"); }
  bool start_object(std::size_t) override {
    if (++depth_ == kRowDepth) row_.assign(table_ == nullptr ? 0 : table_->columns.size(), std::monostate{});
    return depth_ <= kRowDepth || Fail("an object where none belongs");
  }
  bool end_object() override {
    if (depth_-- != kRowDepth || table_ == nullptr) return true;
    const auto taken = importer_.Take(*table_, row_);
    if (taken.ok()) return true;
    failure_ = taken.error();
    return false;
  }
  bool start_array(std::size_t) override {
    return ++depth_ == kRowDepth - 1 || Fail("a list where none belongs");
  }
  bool end_array() override {
    --depth_;
    table_ = nullptr;
    return true;
  }
  bool key(string_t& name) override {
    key_ = name;
    if (depth_ != 2) return true;
    // a table out of turn would refer to what is not there yet
    const auto tables = Tables();
    for (; next_table_ < tables.size(); ++next_table_) {
      if (tables[next_table_].name == name) {
        table_ = &tables[next_table_++];
        return true;
      }
    }
    return Fail("a table that is not known or out of turn");
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;  // core says it
  }

 private:
  static constexpr int kRowDepth = 4;  // object, tables, list, row

  bool Fail(const char* what) {
    failure_ = {ErrorCode::kJsonField, std::string("in the export: ") + what + "; export it again"};
    return false;
  }
  bool Keep(Value value) {
    if (depth_ == 1) {
      if (key_ == "format") has_format_ = value == Value(std::string("trocar-store"));
      if (const auto* whole = std::get_if<std::int64_t>(&value); whole != nullptr && key_ == "version")
        version_ = *whole;
      return true;
    }
    if (depth_ != kRowDepth || table_ == nullptr) return Fail("a value where none belongs");
    if (!has_format_ || version_ != 1) return false;  // Result says why
    for (std::size_t c = 0; c < row_.size(); ++c) {
      if (table_->columns[c].name == key_) {
        row_[c] = std::move(value);
        return true;
      }
    }
    failure_ = BadRow(*table_, "a field is not known");
    return false;
  }

  RowImporter& importer_;
  std::optional<base::Error> failure_;
  const Table* table_ = nullptr;
  std::size_t next_table_ = 0;
  std::vector<Value> row_;
  std::string key_;
  bool has_format_ = false;
  std::int64_t version_ = 0;
  int depth_ = 0;
};

base::Status ImportSqlite(const fs::path& file, RowImporter& importer) {
  auto from = OpenSqlite(file.string(), 2, SqliteUse::kLook);
  if (!from.ok()) return from.error();
  const auto version = ReadSchemaVersion(**from);
  if (!version.ok()) return version.error();
  if (*version != Migrations().back().version)
    return base::Error{ErrorCode::kStoreSchema,
                       file.string() + ": it is of version " + std::to_string(*version) +
                           "; open a copy of it once with trocar store migrate --store COPY"};
  if (auto sound = CheckSqlite(**from); !sound.ok()) return sound;
  return InTransaction(**from, Access::kRead, [&]() -> base::Status {
    for (const Table& table : Tables()) {
      auto taken =
          ForEachRow(**from, table, [&](const Row& row) { return importer.Take(table, row.values); });
      if (!taken.ok()) return taken;
    }
    return {};
  });
}

std::string CsvField(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return host::FormatCsvField(EncodeText(*text));
  const ordered_json json = JsonOf(value);
  return json.is_null() ? "" : host::FormatJson(json);
}

}  // namespace

base::Status ExportJson(Store& store, const Viewer& viewer, const fs::path& file) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  Database& database = store.GetDatabase();
  auto writer = PrivateFileWriter::Start(file);
  if (!writer.ok()) return writer.error();
  auto written = InTransaction(database, Access::kRead, [&]() -> base::Status {
    if (auto begun = writer->Append("{\"format\": \"trocar-store\", \"version\": 1, \"tables\": {");
        !begun.ok())
      return begun;
    for (const Table& table : Tables()) {
      const bool is_first_table = &table == Tables().data();
      std::string separator =
          std::string(is_first_table ? "\n\"" : "],\n\"") + std::string(table.name) + "\": [\n";
      auto taken = ForEachRow(database, table, [&](const Row& row) -> base::Status {
        ordered_json json;
        for (std::size_t c = 0; c < table.columns.size(); ++c)
          json[std::string(table.columns[c].name)] = JsonOf(row.values[c]);
        return writer->Append(std::exchange(separator, ",\n") + host::FormatJson(json));
      });
      if (!taken.ok()) return taken;
      if (separator != ",\n") {
        if (auto empty = writer->Append(separator); !empty.ok()) return empty;
      }
    }
    return writer->Append("]}}\n");
  });
  return written.ok() ? writer->Finish() : written;
}

base::Status ExportCsv(Store& store, const Viewer& viewer, const fs::path& file) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  Database& database = store.GetDatabase();
  auto writer = PrivateFileWriter::Start(file);
  if (!writer.ok()) return writer.error();
  constexpr std::int64_t kAtOnce = 500;
  auto written = InTransaction(database, Access::kRead, [&]() -> base::Status {
    if (auto head =
            writer->Append("recording_id,started,trainee,task,level,patient,seed,completed,passed,metric,"
                           "hand,phase,tool,value,verification\r\n");
        !head.ok())
      return head;
    for (std::int64_t done = -1;;) {
      const auto last = database.Run(
          "SELECT MAX(page.id) FROM (SELECT id FROM attempt WHERE id > $1 ORDER BY id LIMIT $2) page",
          {done, kAtOnce});
      if (!last.ok()) return last.error();
      if (last->rows[0].IsNull(0)) return {};
      const auto rows = database.Run(
          "SELECT attempt.recording_id, attempt.started, person.pseudonym, attempt.task, attempt.level, "
          "attempt.patient, attempt.seed, attempt.completed, attempt.passed, metric.metric, metric.hand, "
          "metric.phase, metric.tool, metric.value, attempt.verification FROM attempt LEFT JOIN person ON "
          "person.id = "
          "attempt.person_id "
          "JOIN metric ON metric.attempt_id = attempt.id WHERE attempt.id > $1 AND attempt.id <= $2 ORDER BY "
          "attempt.id, metric.metric, metric.hand, metric.phase, metric.tool",
          {done, last->rows[0].Int(0)});
      if (!rows.ok()) return rows.error();
      for (const Row& row : rows->rows) {
        std::string line;
        for (const Value& value : row.values) line += (line.empty() ? "" : ",") + CsvField(value);
        if (auto kept = writer->Append(line + "\r\n"); !kept.ok()) return kept;
      }
      done = last->rows[0].Int(0);
    }
  });
  return written.ok() ? writer->Finish() : written;
}

base::Result<ImportReport> Import(Store& store, const Viewer& viewer, const fs::path& file, Trust trust) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return base::Error{ErrorCode::kFileMissing, file.string() + " cannot be opened; check the path"};
  std::string head(15, '\0');
  stream.read(head.data(), 15);
  // a folder opens, and cannot be read
  if (stream.bad())
    return base::Error{ErrorCode::kFileMissing, file.string() + " cannot be opened; check the path"};
  stream.clear();
  stream.seekg(0);
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Result<ImportReport> {
    RowImporter importer(database, trust);
    if (head == "SQLite format 3") {
      if (auto taken = ImportSqlite(file, importer); !taken.ok()) return taken.error();
    } else {
      ExportReader reader(importer);
      const auto read = host::ParseJsonEvents<nlohmann::json_sax<nlohmann::json>>(stream, file.string(),
                                                                                  reader, kExportLimits);
      if (!read.ok()) return read.error();
      if (auto taken = reader.Result(file.string()); !taken.ok()) return taken.error();
    }
    if (auto counted = importer.Finish(); !counted.ok()) return counted.error();
    return importer.report;
  });
}

}  // namespace trocar::store
