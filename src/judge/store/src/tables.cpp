// SPDX-License-Identifier: Apache-2.0
#include "tables.h"

#include <string>

namespace trocar::store {
namespace {

constexpr std::int64_t kRowsAtOnce = 2000;

constexpr ColumnKind kText = ColumnKind::kText, kWhole = ColumnKind::kWhole, kNumber = ColumnKind::kNumber;

std::vector<Table> PeopleTables() {
  return {
      {"person",
       Reference::kPerson,
       "pseudonym",
       "id",
       {{"id", kWhole}, {"pseudonym"}, {"role"}, {"added_ms", kWhole}}},
      {"training_group", Reference::kGroup, "name", "id", {{"id", kWhole}, {"name"}, {"added_ms", kWhole}}},
      {"membership",
       Reference::kNone,
       "",
       "group_id",
       {{"group_id", kWhole, false, Reference::kGroup}, {"person_id", kWhole, false, Reference::kPerson}}}};
}

std::vector<Table> CourseTables() {
  return {{"course",
           Reference::kCourse,
           "course_key,version",
           "id",
           {{"id", kWhole}, {"course_key"}, {"version", kWhole}, {"content"}}},
          {"course_step",
           Reference::kNone,
           "",
           "course_id",
           {{"course_id", kWhole, false, Reference::kCourse},
            {"number", kWhole},
            {"step_key"},
            {"task"},
            {"level"}}},
          {"assignment",
           Reference::kAssignment,
           "",
           "id",
           {{"id", kWhole},
            {"course_id", kWhole, false, Reference::kCourse},
            {"person_id", kWhole, true, Reference::kPerson},
            {"group_id", kWhole, true, Reference::kGroup},
            {"assigned_ms", kWhole},
            {"due_ms", kWhole, true}}},
          {"assignment_due",
           Reference::kNone,
           "",
           "assignment_id",
           {{"assignment_id", kWhole, false, Reference::kAssignment}, {"step_key"}, {"due_ms", kWhole}}},
          {"threshold",
           Reference::kNone,
           "",
           "",
           {{"task"},
            {"level"},
            {"metric"},
            {"hand"},
            {"phase"},
            {"tool"},
            {"value", kNumber},
            {"more_is_better", kWhole},
            {"source"}}}};
}

std::vector<Table> AttemptTables() {
  return {{"attempt",
           Reference::kAttempt,
           "recording_id,started",
           "id",
           {{"id", kWhole},
            {"recording_id"},
            {"started"},
            {"started_ms", kWhole},
            {"person_id", kWhole, true, Reference::kPerson},
            {"task"},
            {"level"},
            {"patient"},
            {"seed"},
            {"seconds", kNumber},
            {"completed", kWhole},
            {"passed", kWhole, true},
            {"score", kNumber, true},
            {"outcome"},
            {"recording_path"},
            {"program"},
            {"verification", kText, false, Reference::kNone, "accepted"},
            {"verification_why", kText, false, Reference::kNone, "earlier"},
            {"verified_by", kText, false, Reference::kNone, ""},
            {"verified_ms", kWhole, true},
            {"claim", kText, false, Reference::kNone, ""},
            {"due_ms", kWhole, true}}},
          {"metric",
           Reference::kNone,
           "",
           "attempt_id",
           {{"attempt_id", kWhole, false, Reference::kAttempt},
            {"metric"},
            {"hand"},
            {"phase"},
            {"tool"},
            {"value", kNumber}}},
          {"rating",
           Reference::kNone,
           "",
           "attempt_id",
           {{"attempt_id", kWhole, false, Reference::kAttempt},
            {"rater_id", kWhole, false, Reference::kPerson},
            {"form"},
            {"item"},
            {"value", kWhole},
            {"rated_ms", kWhole}}},
          {"remark",
           Reference::kNone,
           "",
           "id",
           {{"id", kWhole},
            {"attempt_id", kWhole, false, Reference::kAttempt},
            {"author_id", kWhole, true, Reference::kPerson},
            {"tick", kWhole},
            {"content"},
            {"written_ms", kWhole}}},
          {"certificate",
           Reference::kNone,
           "",
           "id",
           {{"id", kWhole},
            {"certificate_key"},
            {"person_id", kWhole, true, Reference::kPerson},
            {"content"},
            {"issued_ms", kWhole}}}};
}

/// Each after those that it refers to.
std::vector<Table> JoinTables() {
  std::vector<Table> all = PeopleTables();
  for (const auto& more : {CourseTables(), AttemptTables()}) all.insert(all.end(), more.begin(), more.end());
  return all;
}

const std::vector<Table>& AllTables() {
  static const std::vector<Table> tables = JoinTables();
  return tables;
}

}  // namespace

std::span<const Table> Tables() {
  return AllTables();
}

base::Status ForEachRow(Database& database, const Table& table,
                        const std::function<base::Status(const Row&)>& take) {
  std::string select = "SELECT ";
  for (const Column& column : table.columns) {
    if (&column != &table.columns.front()) select += ", ";
    select += column.name;
  }
  select += " FROM " + std::string(table.name);
  const std::string page(table.page);
  const auto hand_over = [&](const std::string& sql, const Parameters& parameters) -> base::Status {
    const auto rows = database.Run(sql, parameters);
    if (!rows.ok()) return rows.error();
    for (const Row& row : rows->rows) {
      if (auto taken = take(row); !taken.ok()) return taken;
    }
    return {};
  };
  if (page.empty()) return hand_over(select, {});
  std::int64_t done = -1;  // ids begin at 1
  while (true) {
    const auto last = database.Run("SELECT MAX(page." + page + ") FROM (SELECT " + page + " FROM " +
                                       std::string(table.name) + " WHERE " + page + " > $1 ORDER BY " + page +
                                       " LIMIT $2) page",
                                   {done, kRowsAtOnce});
    if (!last.ok()) return last.error();
    if (last->rows[0].IsNull(0)) return {};
    const std::int64_t until = last->rows[0].Int(0);
    if (auto taken = hand_over(select + " WHERE " + page + " > $1 AND " + page + " <= $2 ORDER BY " + page,
                               {done, until});
        !taken.ok())
      return taken;
    done = until;
  }
}

std::string InsertText(const Table& table, bool with_own_id) {
  std::string names, places;
  int place = 0;
  for (const Column& column : table.columns) {
    if (!with_own_id && column.name == "id") continue;
    names += std::string(place == 0 ? "" : ", ") + std::string(column.name);
    places += std::string(place == 0 ? "$" : ", $") + std::to_string(place + 1);
    ++place;
  }
  return "INSERT INTO " + std::string(table.name) + " (" + names + ") VALUES (" + places + ")";
}

}  // namespace trocar::store
