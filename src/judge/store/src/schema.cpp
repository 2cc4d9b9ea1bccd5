// SPDX-License-Identifier: Apache-2.0
#include "schema.h"

#include <utility>

namespace trocar::store {
namespace {

constexpr std::string_view kVersion1 = R"(
CREATE TABLE setting (name {text} PRIMARY KEY, value {text} NOT NULL);
CREATE TABLE person (
  id {id},
  pseudonym {text} NOT NULL UNIQUE,
  role {text} NOT NULL CHECK (role IN ('trainee', 'instructor', 'administrator')),
  added_ms BIGINT NOT NULL);
CREATE TABLE training_group (id {id}, name {text} NOT NULL UNIQUE, added_ms BIGINT NOT NULL);
CREATE TABLE membership (
  group_id BIGINT NOT NULL REFERENCES training_group (id) ON DELETE CASCADE,
  person_id BIGINT NOT NULL REFERENCES person (id) ON DELETE CASCADE,
  PRIMARY KEY (group_id, person_id));
CREATE INDEX membership_by_person ON membership (person_id, group_id);
CREATE TABLE course (
  id {id},
  course_key {text} NOT NULL,
  version BIGINT NOT NULL,
  content {text} NOT NULL,
  UNIQUE (course_key, version));
CREATE TABLE course_step (
  course_id BIGINT NOT NULL REFERENCES course (id) ON DELETE CASCADE,
  number BIGINT NOT NULL,
  step_key {text} NOT NULL,
  task {text} NOT NULL,
  level {text} NOT NULL,
  PRIMARY KEY (course_id, number),
  UNIQUE (course_id, step_key));
CREATE TABLE assignment (
  id {id},
  course_id BIGINT NOT NULL REFERENCES course (id) ON DELETE CASCADE,
  person_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  group_id BIGINT REFERENCES training_group (id) ON DELETE CASCADE,
  assigned_ms BIGINT NOT NULL,
  due_ms BIGINT,
  CHECK ((person_id IS NULL) <> (group_id IS NULL)));
CREATE UNIQUE INDEX assignment_of_person ON assignment (person_id, course_id);
CREATE UNIQUE INDEX assignment_of_group ON assignment (group_id, course_id);
CREATE TABLE assignment_due (
  assignment_id BIGINT NOT NULL REFERENCES assignment (id) ON DELETE CASCADE,
  step_key {text} NOT NULL,
  due_ms BIGINT NOT NULL,
  PRIMARY KEY (assignment_id, step_key));
CREATE TABLE threshold (
  task {text} NOT NULL,
  level {text} NOT NULL,
  metric {text} NOT NULL,
  hand {text} NOT NULL,
  phase {text} NOT NULL,
  tool {text} NOT NULL,
  value {number} NOT NULL,
  more_is_better BIGINT NOT NULL,
  source {text} NOT NULL,
  PRIMARY KEY (task, level, metric, hand, phase, tool));
CREATE TABLE attempt (
  id {id},
  recording_id {text} NOT NULL,
  started {text} NOT NULL,
  started_ms BIGINT NOT NULL,
  person_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  task {text} NOT NULL,
  level {text} NOT NULL,
  patient {text} NOT NULL,
  seed {text} NOT NULL,
  seconds {number} NOT NULL,
  completed BIGINT NOT NULL,
  passed BIGINT,
  score {number},
  outcome {text} NOT NULL,
  recording_path {text} NOT NULL,
  program {text} NOT NULL,
  UNIQUE (recording_id, started));
CREATE INDEX attempt_by_person ON attempt (person_id, started_ms, id);
CREATE INDEX attempt_by_person_task ON attempt (person_id, task, started_ms, id);
CREATE INDEX attempt_by_task ON attempt (task, started_ms, id);
CREATE INDEX attempt_by_time ON attempt (started_ms, id);
CREATE TABLE metric (
  attempt_id BIGINT NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  metric {text} NOT NULL,
  hand {text} NOT NULL,
  phase {text} NOT NULL,
  tool {text} NOT NULL,
  value {number} NOT NULL,
  PRIMARY KEY (attempt_id, metric, hand, phase, tool)){compact};
CREATE TABLE standing (
  task {text} NOT NULL,
  level {text} NOT NULL,
  metric {text} NOT NULL,
  hand {text} NOT NULL,
  person_id BIGINT NOT NULL REFERENCES person (id) ON DELETE CASCADE,
  attempts BIGINT NOT NULL,
  latest {number} NOT NULL,
  latest_ms BIGINT NOT NULL,
  lowest {number} NOT NULL,
  highest {number} NOT NULL,
  PRIMARY KEY (task, level, metric, hand, person_id)){compact};
CREATE INDEX standing_by_person ON standing (person_id);
CREATE TABLE rating (
  attempt_id BIGINT NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  rater_id BIGINT NOT NULL REFERENCES person (id) ON DELETE CASCADE,
  form {text} NOT NULL,
  item {text} NOT NULL,
  value BIGINT NOT NULL,
  rated_ms BIGINT NOT NULL,
  PRIMARY KEY (attempt_id, rater_id, form, item));
CREATE INDEX rating_by_rater ON rating (rater_id);
CREATE TABLE remark (
  id {id},
  attempt_id BIGINT NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  author_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  tick BIGINT NOT NULL,
  content {text} NOT NULL,
  written_ms BIGINT NOT NULL);
CREATE INDEX remark_by_attempt ON remark (attempt_id, tick);
CREATE INDEX remark_by_author ON remark (author_id);
CREATE TABLE certificate (
  id {id},
  certificate_key {text} NOT NULL UNIQUE,
  person_id BIGINT REFERENCES person (id) ON DELETE CASCADE,
  content {text} NOT NULL,
  issued_ms BIGINT NOT NULL);
CREATE INDEX certificate_by_person ON certificate (person_id);
CREATE TABLE backup (path {text} PRIMARY KEY, made_ms BIGINT NOT NULL);
-- postgresql: ALTER TABLE person ALTER COLUMN pseudonym SET STATISTICS 0;
-- postgresql: ALTER TABLE attempt ALTER COLUMN recording_id SET STATISTICS 0;
-- postgresql: ALTER TABLE attempt ALTER COLUMN recording_path SET STATISTICS 0;
-- postgresql: ALTER TABLE attempt ALTER COLUMN outcome SET STATISTICS 0;
-- postgresql: ALTER TABLE remark ALTER COLUMN content SET STATISTICS 0;
-- postgresql: ALTER TABLE certificate ALTER COLUMN content SET STATISTICS 0;
-- postgresql: ALTER TABLE certificate ALTER COLUMN certificate_key SET STATISTICS 0;
)";

// A group's values lie together in the index, instead of each on the page of its row; SQLite's table is such an index itself.
constexpr std::string_view kVersion2 = R"(
-- postgresql: CREATE INDEX standing_values ON standing (task, level, metric, hand, person_id, latest, lowest, highest);
)";

// Whether an attempt was replayed, and since when it is older than it may be. What earlier versions kept goes on counting, and says that nobody replayed it.
constexpr std::string_view kVersion3 = R"(
ALTER TABLE attempt ADD COLUMN verification {text} NOT NULL DEFAULT 'unverified'
  CHECK (verification IN ('unverified', 'verified', 'recorded_here', 'accepted', 'refused'));
ALTER TABLE attempt ADD COLUMN verification_why {text} NOT NULL DEFAULT 'not_yet';
ALTER TABLE attempt ADD COLUMN verified_by {text} NOT NULL DEFAULT '';
ALTER TABLE attempt ADD COLUMN verified_ms BIGINT;
ALTER TABLE attempt ADD COLUMN claim {text} NOT NULL DEFAULT '';
ALTER TABLE attempt ADD COLUMN due_ms BIGINT;
UPDATE attempt SET verification = 'accepted', verification_why = 'earlier';
-- postgresql: ALTER TABLE attempt ALTER COLUMN claim SET STATISTICS 0;
)";

constexpr Migration kMigrations[] = {{1, kVersion1}, {2, kVersion2}, {3, kVersion3}};

void Replace(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

std::string Translate(std::string_view sql, Dialect dialect) {
  std::string text(sql);
  const bool is_sqlite = dialect == Dialect::kSqlite;
  Replace(text, "{id}",
          is_sqlite ? "INTEGER PRIMARY KEY" : "BIGINT GENERATED BY DEFAULT AS IDENTITY PRIMARY KEY");
  // order by bytes in both, whatever the server's language is
  Replace(text, "{text}", is_sqlite ? "TEXT" : "TEXT COLLATE \"C\"");
  Replace(text, "{number}", is_sqlite ? "REAL" : "DOUBLE PRECISION");
  Replace(text, "{compact}", is_sqlite ? " WITHOUT ROWID" : "");
  if (!is_sqlite) Replace(text, "-- postgresql: ", "");
  return text;
}

constexpr std::int64_t kMigrationLock = 0x74726f636172;  // "trocar"

base::Error OtherSchema(const std::string& what) {
  return {base::ErrorCode::kStoreSchema, what};
}

}  // namespace

std::span<const Migration> Migrations() noexcept {
  return kMigrations;
}

base::Result<int> ReadSchemaVersion(Database& database) {
  const bool is_sqlite = database.GetDialect() == Dialect::kSqlite;
  const auto tables = database.Run(
      is_sqlite ? "SELECT COUNT(*), SUM(CASE WHEN name = 'setting' THEN 1 ELSE 0 END) FROM "
                  "sqlite_schema WHERE type = 'table'"
                : "SELECT COUNT(*), SUM(CASE WHEN table_name = 'setting' THEN 1 ELSE 0 END) FROM "
                  "information_schema.tables WHERE table_schema = current_schema()");
  if (!tables.ok()) return tables.error();
  if (tables->rows[0].Int(0) == 0) return 0;
  if (tables->rows[0].Int(1) == 0)
    return OtherSchema("the database holds tables of another program; name an empty one, or another file");
  const auto version = database.Run("SELECT value FROM setting WHERE name = 'schema'");
  if (!version.ok()) return version.error();
  if (version->rows.size() != 1)
    return OtherSchema("the database does not say which version its tables are; restore a backup");
  return std::atoi(version->rows[0].Text(0).c_str());
}

base::Result<int> Migrate(Database& database, std::span<const Migration> migrations) {
  return InTransaction(database, Access::kWrite, [&]() -> base::Result<int> {
    if (database.GetDialect() == Dialect::kPostgres) {
      if (auto locked = database.Run("SELECT pg_advisory_xact_lock($1)", {kMigrationLock}); !locked.ok())
        return locked.error();
    }
    const auto before = ReadSchemaVersion(database);
    if (!before.ok()) return before;
    if (*before > migrations.back().version)
      return OtherSchema("the store is of version " + std::to_string(*before) + ", this program knows " +
                         std::to_string(migrations.back().version) + "; use a newer program");
    for (const Migration& step : migrations) {
      if (step.version <= *before) continue;
      if (auto done = database.RunScript(Translate(step.sql, database.GetDialect())); !done.ok())
        return done.error();
      const std::string version = std::to_string(step.version);
      if (auto noted =
              database.Run("INSERT INTO setting (name, value) VALUES ('schema', $1) ON CONFLICT (name) DO "
                           "UPDATE SET value = excluded.value",
                           {version});
          !noted.ok())
        return noted.error();
    }
    return before;
  });
}

}  // namespace trocar::store
