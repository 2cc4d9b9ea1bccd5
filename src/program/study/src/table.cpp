// SPDX-License-Identifier: Apache-2.0
#include "table.h"

#include <sqlite3.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "trocar/dataset/hdf5_file.h"
#include "trocar/host/csv_field.h"
#include "trocar/host/json_text.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"

namespace trocar::study {
namespace {

constexpr std::size_t kInputColumns = 5;  // before the parameters

std::string FormatExactly(double value) {
  return host::FormatJson(nlohmann::json(value));  // the shortest text that is read back as the same number
}

std::vector<std::string> ListColumns(const StudyPlan& plan, std::span<const Row> rows) {
  std::vector<std::string> columns = {"index", "key", "surgeon", "patient", "seed"};
  for (const ParameterValues& parameter : plan.parameters) columns.push_back(parameter.name);
  columns.insert(columns.end(), {"outcome", "state_hash"});
  if (!rows.empty())
    for (const auto& [name, value] : rows.front().result.numbers) columns.push_back(name);
  return columns;
}

std::vector<std::string> ListValues(const Row& row) {
  std::vector<std::string> values = {std::to_string(row.run.index), row.run.key, row.run.surgeon,
                                     row.run.patient.filename().string(), std::to_string(row.run.seed)};
  for (const double value : row.run.values) values.push_back(FormatExactly(value));
  values.insert(values.end(), {row.result.outcome, row.result.state_hash});
  for (const auto& [name, value] : row.result.numbers) values.push_back(FormatExactly(value));
  return values;
}

/// Key, surgeon, patient; outcome and state hash stand behind the parameters.
bool IsText(const StudyPlan& plan, std::size_t column) {
  const std::size_t outcome = kInputColumns + plan.parameters.size();
  return (column >= 1 && column <= 3) || column == outcome || column == outcome + 1;
}

base::Status TakeName(const host::PartialPath& part, const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::rename(part.Path(), path, failure);
  if (failure)
    return base::Error{base::ErrorCode::kFileUnwritable,
                       path.string() + ": " + failure.message() + "; check the folder"};
  return {};
}

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct CloseStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

}  // namespace

base::Status WriteCsv(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows) {
  std::string text;
  const std::vector<std::string> columns = ListColumns(plan, rows);
  for (std::size_t i = 0; i < columns.size(); ++i)
    text += (i > 0 ? "," : "") + host::FormatCsvField(columns[i]);
  text += "\n";
  for (const Row& row : rows) {
    const std::vector<std::string> values = ListValues(row);
    for (std::size_t i = 0; i < values.size(); ++i)
      text += (i > 0 ? "," : "") + (IsText(plan, i) ? host::FormatCsvField(values[i]) : values[i]);
    text += "\n";
  }
  return host::WriteFile(path, text);
}

base::Status WriteSqlite(const std::filesystem::path& path, const StudyPlan& plan,
                         std::span<const Row> rows) {
  const host::PartialPath part(path);
  sqlite3* opened = nullptr;
  const int status = sqlite3_open(part.Path().c_str(), &opened);
  const std::unique_ptr<sqlite3, CloseDatabase> database(opened);
  const auto failed = [&] {
    return base::Error{
        base::ErrorCode::kFileUnwritable,
        path.string() + ": " + sqlite3_errmsg(opened) + "; check the folder, its rights and the space left"};
  };
  if (status != SQLITE_OK) return failed();
  const std::vector<std::string> columns = ListColumns(plan, rows);
  std::string make = "CREATE TABLE runs (", insert = "INSERT INTO runs VALUES (";
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const bool is_whole = i == 0 || i == kInputColumns - 1;
    make += (i > 0 ? ", \"" : "\"") + columns[i] +
            (IsText(plan, i) ? "\" TEXT"
             : is_whole      ? "\" INTEGER"
                             : "\" REAL");
    if (columns[i] == "key") make += " UNIQUE";
    insert += i > 0 ? ", ?" : "?";
  }
  const std::string begin = make + "); BEGIN";
  if (sqlite3_exec(opened, begin.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) return failed();
  sqlite3_stmt* prepared = nullptr;
  insert += ")";
  if (sqlite3_prepare_v2(opened, insert.c_str(), -1, &prepared, nullptr) != SQLITE_OK) return failed();
  const std::unique_ptr<sqlite3_stmt, CloseStatement> statement(prepared);
  for (const Row& row : rows) {
    const std::vector<std::string> values = ListValues(row);
    for (std::size_t i = 0; i < values.size(); ++i)
      sqlite3_bind_text(prepared, static_cast<int>(i + 1), values[i].c_str(), -1, SQLITE_TRANSIENT);
    if (sqlite3_step(prepared) != SQLITE_DONE) return failed();
    sqlite3_reset(prepared);
  }
  if (sqlite3_exec(opened, "COMMIT", nullptr, nullptr, nullptr) != SQLITE_OK) return failed();
  return TakeName(part, path);
}

base::Status WriteHdf5(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows) {
  const host::PartialPath part(path);
  auto file = dataset::Hdf5File::Make(part.Path());
  if (!file) return file.error();
  const auto add_texts = [&](const std::string& name, const auto& text_of) {
    std::vector<std::string> texts;
    for (const Row& row : rows) texts.push_back(text_of(row));
    return file->SetTexts(name, texts);
  };
  const auto add_numbers = [&](const std::string& name, const auto& number_of) {
    base::Status status;
    for (const Row& row : rows) {
      const double number = number_of(row);
      if (status.ok()) status = file->Append<double>(name, {}, std::span(&number, 1));
    }
    return status;
  };
  std::vector<base::Status> done = {
      add_numbers("index", [](const Row& row) { return static_cast<double>(row.run.index); }),
      add_texts("key", [](const Row& row) { return row.run.key; }),
      add_texts("surgeon", [](const Row& row) { return row.run.surgeon; }),
      add_texts("patient", [](const Row& row) { return row.run.patient.filename().string(); }),
      add_numbers("seed", [](const Row& row) { return static_cast<double>(row.run.seed); }),
      add_texts("outcome", [](const Row& row) { return row.result.outcome; }),
      add_texts("state_hash", [](const Row& row) { return row.result.state_hash; })};
  for (std::size_t i = 0; i < plan.parameters.size(); ++i)
    done.push_back(add_numbers(plan.parameters[i].name, [i](const Row& row) { return row.run.values[i]; }));
  for (std::size_t i = 0; !rows.empty() && i < rows.front().result.numbers.size(); ++i)
    done.push_back(add_numbers(rows.front().result.numbers[i].first,
                               [i](const Row& row) { return row.result.numbers[i].second; }));
  done.push_back(file->Close());
  for (const base::Status& status : done) {
    if (!status) return status;
  }
  return TakeName(part, path);
}

}  // namespace trocar::study
