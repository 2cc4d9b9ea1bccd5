// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/courses.h"

#include <cmath>
#include <set>
#include <utility>

#include "database.h"
#include "sql.h"

namespace trocar::store {
namespace {

base::Status MayTeach(const Viewer& viewer) {
  if (viewer.role == Role::kTrainee) return Refused("this is for instructors and administrators");
  return {};
}

base::Error NoCourse() {
  return Unknown("the store knows no such course, or not this version of it");
}

base::Result<std::int64_t> FindCourseId(Database& database, std::string_view key, int version) {
  const auto found =
      version > 0 ? database.Run("SELECT id FROM course WHERE course_key = $1 AND version = $2",
                                 {std::string(key), std::int64_t{version}})
                  : database.Run("SELECT id FROM course WHERE course_key = $1 ORDER BY version DESC LIMIT 1",
                                 {std::string(key)});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return NoCourse();
  return found->rows[0].Int(0);
}

/// Who shall do it: a member of the viewer's groups, or one of those groups.
base::Result<std::int64_t> FindAssigned(Store& store, const Viewer& viewer, const Assignment& assignment) {
  if (!assignment.trainee.empty()) {
    const auto person = FindPerson(store, assignment.trainee);
    if (!person.ok()) return person.error();
    if (auto may = MaySee(store, viewer, person->id); !may.ok()) return may.error();
    return person->id;
  }
  const auto group = FindGroup(store, assignment.group);
  if (!group.ok()) return group.error();
  if (viewer.role != Role::kAdministrator) {
    const auto own = store.GetDatabase().Run(
        "SELECT 1 FROM membership WHERE group_id = $1 AND person_id = $2", {group->id, viewer.person});
    if (!own.ok()) return own.error();
    if (own->rows.empty()) return Refused("an instructor assigns only to groups that they belong to");
  }
  return group->id;
}

}  // namespace

base::Status AddCourse(Store& store, const Viewer& viewer, const Course& course) {
  if (auto may = MayTeach(viewer); !may.ok()) return may;
  if (course.key.empty() || course.version < 1 || course.steps.empty())
    return Invalid("a course has a key, a version from 1 on, and a step");
  std::set<std::string> keys;
  for (const CourseStep& step : course.steps) {
    if (step.key.empty() || !keys.insert(step.key).second)
      return Invalid("a step of the course has no key, or that of another step");
  }
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    const auto there = database.Run("SELECT content FROM course WHERE course_key = $1 AND version = $2",
                                    {course.key, std::int64_t{course.version}});
    if (!there.ok()) return there.error();
    if (!there->rows.empty()) {
      if (there->rows[0].Text(0) == course.text) return {};
      return Invalid(
          "this version of the course is there with another text; give the new text a new version");
    }
    const auto added =
        database.Run("INSERT INTO course (course_key, version, content) VALUES ($1, $2, $3) RETURNING id",
                     {course.key, std::int64_t{course.version}, course.text});
    if (!added.ok()) return added.error();
    std::int64_t number = 0;
    for (const CourseStep& step : course.steps) {
      const auto kept = database.Run(
          "INSERT INTO course_step (course_id, number, step_key, task, level) VALUES ($1, $2, $3, $4, $5)",
          {added->rows[0].Int(0), ++number, step.key, step.task, step.level});
      if (!kept.ok()) return kept.error();
    }
    return {};
  });
}

base::Result<Course> FindCourse(Store& store, std::string_view key, int version) {
  Database& database = store.GetDatabase();
  const auto id = FindCourseId(database, key, version);
  if (!id.ok()) return id.error();
  const auto found = database.Run("SELECT course_key, version, content FROM course WHERE id = $1", {*id});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return NoCourse();
  Course course{found->rows[0].Text(0), static_cast<int>(found->rows[0].Int(1)), found->rows[0].Text(2), {}};
  const auto steps = database.Run(
      "SELECT step_key, task, level FROM course_step WHERE course_id = $1 ORDER BY number", {*id});
  if (!steps.ok()) return steps.error();
  for (const Row& row : steps->rows) course.steps.push_back({row.Text(0), row.Text(1), row.Text(2)});
  return course;
}

base::Result<std::vector<Course>> ListCourses(Store& store) {
  const auto found = store.GetDatabase().Run(
      "SELECT course_key, MAX(version) FROM course GROUP BY course_key ORDER BY course_key");
  if (!found.ok()) return found.error();
  std::vector<Course> courses;
  for (const Row& row : found->rows) courses.push_back({row.Text(0), static_cast<int>(row.Int(1)), "", {}});
  return courses;
}

base::Status AddAssignment(Store& store, const Viewer& viewer, const Assignment& assignment) {
  if (auto may = MayTeach(viewer); !may.ok()) return may;
  if (assignment.trainee.empty() == assignment.group.empty())
    return Invalid("a course is assigned to a trainee or to a group");
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    const auto course = FindCourseId(database, assignment.course, assignment.version);
    if (!course.ok()) return course.error();
    const auto whom = FindAssigned(store, viewer, assignment);
    if (!whom.ok()) return whom.error();
    const std::string column = assignment.trainee.empty() ? "group_id" : "person_id";
    const auto added =
        database.Run("INSERT INTO assignment (course_id, " + column +
                         ", assigned_ms, due_ms) VALUES ($1, $2, $3, $4) ON CONFLICT (" + column +
                         ", course_id) DO UPDATE SET due_ms = excluded.due_ms RETURNING id",
                     {*course, *whom, NowMilliseconds(), OrNull(assignment.due_ms)});
    if (!added.ok()) return added.error();
    const std::int64_t id = added->rows[0].Int(0);
    if (auto cleared = database.Run("DELETE FROM assignment_due WHERE assignment_id = $1", {id});
        !cleared.ok())
      return cleared.error();
    for (const StepDue& due : assignment.step_due) {
      const auto kept = database.Run(
          "INSERT INTO assignment_due (assignment_id, step_key, due_ms) SELECT CAST($1 AS BIGINT), step_key, "
          "CAST($2 AS BIGINT) FROM course_step "
          "WHERE course_id = $3 AND step_key = $4",
          {id, due.due_ms, *course, due.step});
      if (!kept.ok()) return kept.error();
      if (kept->changed == 0) return Invalid("a date is of a step that the course has not");
    }
    return {};
  });
}

base::Result<std::vector<Assignment>> ListAssignments(Store& store, const Viewer& viewer,
                                                      std::string_view trainee) {
  const auto person = FindPerson(store, trainee);
  if (!person.ok()) return person.error();
  if (auto may = MaySee(store, viewer, person->id); !may.ok()) return may.error();
  Database& database = store.GetDatabase();
  const auto found = database.Run(
      "SELECT assignment.id, course.course_key, course.version, training_group.name, assignment.due_ms FROM "
      "assignment JOIN course ON course.id = assignment.course_id LEFT JOIN training_group ON "
      "training_group.id = "
      "assignment.group_id WHERE assignment.person_id = $1 OR assignment.group_id IN (SELECT group_id FROM "
      "membership WHERE person_id = $1) ORDER BY CASE WHEN assignment.due_ms IS NULL THEN 1 ELSE 0 END, "
      "assignment.due_ms, assignment.id",
      {person->id});
  if (!found.ok()) return found.error();
  std::vector<Assignment> assignments;
  for (const Row& row : found->rows) {
    Assignment assignment{row.Text(1), static_cast<int>(row.Int(2)), "", "", row.IntOrNull(4), {}};
    if (row.IsNull(3))
      assignment.trainee = trainee;
    else
      assignment.group = row.Text(3);
    const auto dates = database.Run(
        "SELECT step_key, due_ms FROM assignment_due WHERE assignment_id = $1 ORDER BY due_ms, step_key",
        {row.Int(0)});
    if (!dates.ok()) return dates.error();
    for (const Row& date : dates->rows) assignment.step_due.push_back({date.Text(0), date.Int(1)});
    assignments.push_back(std::move(assignment));
  }
  return assignments;
}

base::Status SetThreshold(Store& store, const Viewer& viewer, const Threshold& threshold) {
  if (auto may = MayTeach(viewer); !may.ok()) return may;
  const MetricKey& key = threshold.key;
  if (key.task.empty() || key.metric.empty() || !std::isfinite(threshold.value))
    return Invalid("a threshold has a task, a metric, and a finite value");
  const auto set = store.GetDatabase().Run(
      "INSERT INTO threshold (task, level, metric, hand, phase, tool, value, more_is_better, source) VALUES "
      "($1, $2, "
      "$3, $4, $5, $6, $7, $8, $9) ON CONFLICT (task, level, metric, hand, phase, tool) DO UPDATE SET value "
      "= "
      "excluded.value, more_is_better = excluded.more_is_better, source = excluded.source",
      {key.task, key.level, key.metric, key.hand, key.phase, key.tool, threshold.value,
       std::int64_t{threshold.more_is_better}, threshold.source});
  return set.ok() ? base::Status() : set.error();
}

base::Result<std::vector<Threshold>> ListThresholds(Store& store, std::string_view task,
                                                    std::string_view level) {
  const auto found = store.GetDatabase().Run(
      "SELECT metric, hand, phase, tool, value, more_is_better, source FROM threshold WHERE task = $1 AND "
      "level = $2 "
      "ORDER BY metric, hand, phase, tool",
      {std::string(task), std::string(level)});
  if (!found.ok()) return found.error();
  std::vector<Threshold> thresholds;
  for (const Row& row : found->rows) {
    thresholds.push_back(
        {{std::string(task), std::string(level), row.Text(0), row.Text(1), row.Text(2), row.Text(3)},
         row.Real(4),
         row.Int(5) != 0,
         row.Text(6)});
  }
  return thresholds;
}

}  // namespace trocar::store
