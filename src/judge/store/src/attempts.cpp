// SPDX-License-Identifier: Apache-2.0
#include "trocar/store/attempts.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "attempt_rows.h"
#include "database.h"
#include "sql.h"
#include "trocar/host/json.h"
#include "trocar/store/courses.h"

namespace trocar::store {
namespace {

constexpr std::size_t kLongestText = 1000;  // of task, level, metric and the like [bytes]
constexpr std::size_t kRowsAtOnce = 40;     // metrics in one statement
constexpr int kMostPerPage = 1000;

constexpr std::string_view kColumns =
    "attempt.id, attempt.recording_id, attempt.started, person.pseudonym, attempt.task, attempt.level, "
    "attempt.patient, attempt.seed, attempt.seconds, attempt.completed, attempt.passed, attempt.score, "
    "attempt.outcome, attempt.recording_path, attempt.program, attempt.started_ms, attempt.verification, "
    "attempt.verification_why, attempt.verified_by, attempt.verified_ms, attempt.claim";
constexpr std::size_t kStartedColumn = 15;
constexpr std::string_view kFrom = " FROM attempt LEFT JOIN person ON person.id = attempt.person_id WHERE ";

StoredAttempt ReadAttempt(const Row& row) {
  StoredAttempt stored;
  stored.id = row.Int(0);
  Attempt& a = stored.attempt;
  a.recording_id = row.Text(1);
  a.started = row.Text(2);
  if (!row.IsNull(3)) a.trainee = row.Text(3);
  a.task = row.Text(4);
  a.level = row.Text(5);
  a.patient = row.Text(6);
  const std::string& seed = row.Text(7);
  std::from_chars(seed.data(), seed.data() + seed.size(), a.seed);
  a.seconds = row.Real(8);
  a.is_completed = row.Int(9) != 0;
  if (!row.IsNull(10)) a.is_passed = row.Int(10) != 0;
  a.score = row.RealOrNull(11);
  a.outcome = row.Text(12);
  a.recording = row.Text(13);
  a.program = row.Text(14);
  // a word that this program does not know counts as nothing
  a.mark.state = ParseVerification(row.Text(16)).value_or(Verification::kUnverified);
  a.mark.why = ParseWhy(row.Text(17)).value_or(WhyUnverified::kNotYet);
  a.mark.program = row.Text(18);
  a.mark.time_ms = row.IntOrNull(19);
  a.mark.claim = row.Text(20);
  return stored;
}

base::Status AddMetrics(Database& database, std::int64_t id,
                        const std::vector<training::MetricValue>& metrics) {
  for (std::size_t begin = 0; begin < metrics.size(); begin += kRowsAtOnce) {
    const std::size_t end = std::min(metrics.size(), begin + kRowsAtOnce);
    std::string sql = "INSERT INTO metric (attempt_id, metric, hand, phase, tool, value) VALUES ";
    Parameters parameters{id};
    for (std::size_t i = begin; i < end; ++i) {
      const training::MetricValue& m = metrics[i];
      sql += i == begin ? "($1" : ", ($1";
      for (const std::string* text : {&m.metric, &m.hand, &m.phase, &m.tool})
        sql += ", " + Put(parameters, *text);
      sql += ", " + Put(parameters, m.value) + ")";
    }
    if (auto added = database.Run(sql, parameters); !added.ok()) return added.error();
  }
  return {};
}

constexpr std::string_view kRaiseStanding =
    "INSERT INTO standing (task, level, metric, hand, person_id, attempts, latest, latest_ms, lowest, "
    "highest) "
    "SELECT attempt.task, attempt.level, metric.metric, metric.hand, attempt.person_id, 1, metric.value, "
    "attempt.started_ms, metric.value, metric.value FROM metric JOIN attempt ON attempt.id = "
    "metric.attempt_id "
    "WHERE attempt.id = $1 AND metric.phase = '' AND metric.tool = '' ORDER BY metric.metric, metric.hand "
    "ON CONFLICT (task, level, metric, hand, person_id) DO UPDATE SET attempts = standing.attempts + 1, "
    "latest = CASE WHEN excluded.latest_ms >= standing.latest_ms THEN excluded.latest ELSE standing.latest "
    "END, "
    "latest_ms = CASE WHEN excluded.latest_ms >= standing.latest_ms THEN excluded.latest_ms ELSE "
    "standing.latest_ms END, "
    "lowest = CASE WHEN excluded.lowest < standing.lowest THEN excluded.lowest ELSE standing.lowest END, "
    "highest = CASE WHEN excluded.highest > standing.highest THEN excluded.highest ELSE standing.highest END";

/// By the thresholds of its task and level; nothing where there are none.
base::Result<std::optional<bool>> Judge(Store& store, const Attempt& attempt,
                                        const std::vector<training::MetricValue>& metrics) {
  const auto thresholds = ListThresholds(store, attempt.task, attempt.level);
  if (!thresholds.ok()) return thresholds.error();
  if (thresholds->empty()) return std::optional<bool>();
  if (!attempt.is_completed) return std::optional<bool>(false);
  for (const Threshold& t : *thresholds) {
    const auto found = std::find_if(metrics.begin(), metrics.end(), [&](const training::MetricValue& m) {
      return m.metric == t.key.metric && m.hand == t.key.hand && m.phase == t.key.phase &&
             m.tool == t.key.tool;
    });
    if (found == metrics.end() || (t.more_is_better ? found->value < t.value : found->value > t.value))
      return std::optional<bool>(false);
  }
  return std::optional<bool>(true);
}

/// The attempt's person. \return kStoreUnknown, kStoreRefused
base::Status MaySeeAttempt(Store& store, const Viewer& viewer, std::int64_t id) {
  const auto found = store.GetDatabase().Run("SELECT person_id FROM attempt WHERE id = $1", {id});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return Unknown("the store has no such attempt; trocar store attempts lists them");
  return MaySee(store, viewer, found->rows[0].IntOrNull(0).value_or(-1));
}

/// Whether a page is found sooner among the newest attempts of all than among all attempts of the group: with 0.5 % of the people,
/// 20 of theirs are expected among 4,000; all of theirs would be 5,000 of a million.
base::Result<bool> IsLargeGroup(Database& database, std::int64_t group) {
  constexpr std::int64_t kShare = 200;
  const auto counts = database.Run(
      "SELECT (SELECT COUNT(*) FROM membership WHERE group_id = $1), (SELECT COUNT(*) FROM person)", {group});
  if (!counts.ok()) return counts.error();
  return kShare * counts->rows[0].Int(0) > counts->rows[0].Int(1);
}

struct Cursor {
  std::int64_t started_ms = 0, id = 0;
};

base::Result<Cursor> ParseCursor(const std::string& text) {
  Cursor cursor;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, cursor.started_ms);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '.') {
    const auto second = std::from_chars(first.ptr + 1, end, cursor.id);
    if (second.ec == std::errc() && second.ptr == end) return cursor;
  }
  return base::Error{base::ErrorCode::kUsage, "this is no page; the end of each page names the next"};
}

bool IsRatingItem(const Rating& rating) {
  static constexpr std::string_view kGoals[] = {"depth_perception", "bimanual_dexterity", "efficiency",
                                                "tissue_handling", "autonomy"};
  static constexpr std::string_view kOsats[] = {
      "respect_for_tissue", "time_and_motion",   "instrument_handling",   "knowledge_of_instruments",
      "use_of_assistants",  "flow_and_planning", "knowledge_of_procedure"};
  const auto has = [&](const auto& items) {
    return std::find(std::begin(items), std::end(items), rating.item) != std::end(items);
  };
  return (rating.form == "GOALS" && has(kGoals)) || (rating.form == "OSATS" && has(kOsats));
}

}  // namespace

base::Status CheckOutcome(std::string_view outcome) {
  const auto read = host::ParseJson<nlohmann::json>(outcome, "the outcome of an attempt", host::kSmallJson);
  if (read.ok() || read.error().code != base::ErrorCode::kFileTooLarge) return {};
  return Invalid(read.error().message);
}

base::Status CheckAttempt(const Attempt& attempt) {
  if (!attempt.trainee.empty() && attempt.trainee.size() > kLongestText)
    return Invalid("the trainee of the attempt is no pseudonym");
  if (attempt.recording_id.empty() || attempt.started.empty() || attempt.task.empty())
    return Invalid("an attempt needs its recording's id, when it started, and its task");
  for (const std::string* text : {&attempt.recording_id, &attempt.started, &attempt.task, &attempt.level}) {
    if (text->size() > kLongestText) return Invalid("a text of the attempt is longer than 1000 bytes");
  }
  bool is_finite = std::isfinite(attempt.seconds) && std::isfinite(attempt.score.value_or(0));
  for (const training::MetricValue& m : attempt.metrics) {
    is_finite = is_finite && std::isfinite(m.value);
    if (m.metric.empty() || m.metric.size() > kLongestText || m.phase.size() > kLongestText ||
        m.tool.size() > kLongestText || m.hand.size() > kLongestText)
      return Invalid("a metric needs a name, and no text of it may be longer than 1000 bytes");
  }
  if (!is_finite)
    return Invalid("a number of the attempt is not finite; a metric that is undefined is left out");
  return CheckOutcome(attempt.outcome);
}

std::vector<training::MetricValue> ListMetrics(const Attempt& attempt) {
  std::vector<training::MetricValue> metrics = attempt.metrics;
  const auto add = [&](const char* name, double value) {
    const bool is_there = std::any_of(metrics.begin(), metrics.end(), [&](const training::MetricValue& m) {
      return m.metric == name && m.hand.empty() && m.phase.empty() && m.tool.empty();
    });
    if (!is_there) metrics.push_back({name, "", "", value, ""});
  };
  if (attempt.score) add("score", *attempt.score);
  add("seconds", attempt.seconds);
  const auto key = [](const training::MetricValue& m) { return std::tie(m.metric, m.hand, m.phase, m.tool); };
  std::sort(metrics.begin(), metrics.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return metrics;
}

base::Result<std::int64_t> ParseTime(std::string_view text) {
  const base::Error wrong = Invalid("a time is written like 2026-11-24T22:50:20+01:00");
  std::size_t at = 0;
  const auto take = [&](std::size_t digits) {
    int number = -1;
    if (at + digits <= text.size() && std::all_of(text.begin() + static_cast<std::ptrdiff_t>(at),
                                                  text.begin() + static_cast<std::ptrdiff_t>(at + digits),
                                                  [](char c) { return c >= '0' && c <= '9'; }))
      std::from_chars(text.data() + at, text.data() + at + digits, number);
    at += digits;
    return number;
  };
  const auto skip = [&](char c) { return at < text.size() && text[at++] == c; };
  const int year = take(4);
  bool is_good = year >= 0 && skip('-');
  const int month = take(2);
  is_good = is_good && skip('-');
  const int day = take(2);
  is_good = is_good && skip('T');
  const int hour = take(2);
  is_good = is_good && skip(':');
  const int minute = take(2);
  is_good = is_good && skip(':');
  const int second = take(2);
  const std::chrono::year_month_day date{std::chrono::year{year},
                                         std::chrono::month{static_cast<unsigned>(month)},
                                         std::chrono::day{static_cast<unsigned>(day)}};
  if (!is_good || !date.ok() || hour < 0 || hour > 23 || minute < 0 || minute > 59 || second < 0 ||
      second > 60)
    return wrong;
  std::int64_t milliseconds = 0;
  if (at < text.size() && text[at] == '.') {
    std::int64_t scale = 100;
    for (++at; at < text.size() && text[at] >= '0' && text[at] <= '9'; ++at, scale /= 10)
      milliseconds += scale * (text[at] - '0');
  }
  std::int64_t offset = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) {
    const int sign = text[at++] == '+' ? 1 : -1;
    const int hours = take(2);
    if (at < text.size() && text[at] == ':') ++at;  // recordings of before 2026-11-25 have none
    const int minutes = take(2);
    if (hours < 0 || hours > 23 || minutes < 0 || minutes > 59) return wrong;
    offset = sign * (60 * hours + minutes);
  } else if (!skip('Z')) {
    return wrong;
  }
  if (at != text.size()) return wrong;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  const std::int64_t seconds = 86400 * days + 3600 * hour + 60 * (minute - offset) + second;
  return 1000 * seconds + milliseconds;
}

base::Result<bool> IsAnothers(Database& database, const Attempt& attempt) {
  const auto there = database.Run(
      "SELECT person.pseudonym FROM attempt LEFT JOIN person ON person.id = attempt.person_id WHERE "
      "attempt.recording_id = $1 AND attempt.started = $2",
      {attempt.recording_id, attempt.started});
  if (!there.ok()) return there.error();
  if (there->rows.empty()) return false;
  const Row& row = there->rows[0];
  return (row.IsNull(0) ? std::string() : row.Text(0)) != attempt.trainee;
}

base::Result<bool> AddAttempt(Store& store, const Attempt& attempt) {
  if (auto sound = CheckAttempt(attempt); !sound.ok()) return sound.error();
  const auto started_ms = ParseTime(attempt.started);
  if (!started_ms.ok()) return started_ms.error();
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Result<bool> {
    std::optional<std::int64_t> person;
    if (!attempt.trainee.empty()) {
      const auto found = FindPerson(store, attempt.trainee);
      if (!found.ok()) return found.error();
      person = found->id;
    }
    const std::vector<training::MetricValue> metrics = ListMetrics(attempt);
    std::optional<bool> is_passed = attempt.is_passed;
    if (!is_passed) {
      const auto judged = Judge(store, attempt, metrics);
      if (!judged.ok()) return judged.error();
      is_passed = *judged;
    }
    const auto added = database.Run(
        "INSERT INTO attempt (recording_id, started, started_ms, person_id, task, level, patient, seed, "
        "seconds, "
        "completed, passed, score, outcome, recording_path, program, verification, verification_why, "
        "verified_by, verified_ms, claim) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, "
        "$10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20) ON CONFLICT (recording_id, started) DO "
        "NOTHING RETURNING id",
        {attempt.recording_id,
         attempt.started,
         *started_ms,
         OrNull(person),
         attempt.task,
         attempt.level,
         attempt.patient,
         std::to_string(attempt.seed),
         attempt.seconds,
         std::int64_t{attempt.is_completed},
         OrNull(is_passed),
         OrNull(attempt.score),
         attempt.outcome.empty() ? std::string("{}") : attempt.outcome,
         attempt.recording,
         attempt.program,
         std::string(VerificationName(attempt.mark.state)),
         std::string(WhyName(attempt.mark.why)),
         attempt.mark.program,
         OrNull(attempt.mark.time_ms),
         attempt.mark.claim});
    if (!added.ok()) return added.error();
    if (added->rows.empty()) {
      const auto is_anothers = IsAnothers(database, attempt);
      if (!is_anothers.ok()) return is_anothers.error();
      if (*is_anothers) return Conflict();
      return false;
    }
    const std::int64_t id = added->rows[0].Int(0);
    if (auto kept = AddMetrics(database, id, metrics); !kept.ok()) return kept.error();
    if (person && attempt.CountsAsCompleted()) {
      if (auto raised = database.Run(kRaiseStanding, {id}); !raised.ok()) return raised.error();
    }
    return true;
  });
}

base::Status MoveAttempt(Store& store, const Viewer& viewer, std::string_view recording_id,
                         std::string_view started, std::string_view trainee) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    const auto to = FindPerson(store, trainee);
    if (!to.ok()) return to.error();
    const auto there =
        database.Run("SELECT id, person_id FROM attempt WHERE recording_id = $1 AND started = $2",
                     {std::string(recording_id), std::string(started)});
    if (!there.ok()) return there.error();
    if (there->rows.empty()) return {};  // there is nothing to move
    if (auto moved =
            database.Run("UPDATE attempt SET person_id = $2 WHERE id = $1", {there->rows[0].Int(0), to->id});
        !moved.ok())
      return moved.error();
    if (const auto from = there->rows[0].IntOrNull(1)) {
      if (auto counted = RecalcStandings(database, *from); !counted.ok()) return counted;
    }
    return RecalcStandings(database, to->id);
  });
}

base::Status UpdateAttempt(Store& store, const Viewer& viewer, const Attempt& attempt) {
  if (auto may = MayManage(viewer); !may.ok()) return may;
  if (auto sound = CheckAttempt(attempt); !sound.ok()) return sound;
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    const std::vector<training::MetricValue> metrics = ListMetrics(attempt);
    std::optional<bool> is_passed = attempt.is_passed;
    if (!is_passed) {
      const auto judged = Judge(store, attempt, metrics);
      if (!judged.ok()) return judged.error();
      is_passed = *judged;
    }
    const auto changed = database.Run(
        "UPDATE attempt SET seconds = $3, completed = $4, passed = $5, score = $6, outcome = $7, "
        "verification = $8, verification_why = $9, verified_by = $10, verified_ms = $11, claim = $12 "
        "WHERE recording_id = $1 AND started = $2 RETURNING id, person_id",
        {attempt.recording_id, attempt.started, attempt.seconds, std::int64_t{attempt.is_completed},
         OrNull(is_passed), OrNull(attempt.score),
         attempt.outcome.empty() ? std::string("{}") : attempt.outcome,
         std::string(VerificationName(attempt.mark.state)), std::string(WhyName(attempt.mark.why)),
         attempt.mark.program, OrNull(attempt.mark.time_ms), attempt.mark.claim});
    if (!changed.ok()) return changed.error();
    if (changed->rows.empty())
      return Unknown("the attempt is not in the store any more; trocar store attempts lists what is");
    const std::int64_t id = changed->rows[0].Int(0);
    if (auto gone = database.Run("DELETE FROM metric WHERE attempt_id = $1", {id}); !gone.ok())
      return gone.error();
    if (auto kept = AddMetrics(database, id, metrics); !kept.ok()) return kept;
    if (const auto person = changed->rows[0].IntOrNull(1)) return RecalcStandings(database, *person);
    return {};
  });
}

base::Result<std::vector<StoredAttempt>> ListUnverified(Store& store, const Viewer& viewer,
                                                        std::int64_t after, int limit) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  Database& database = store.GetDatabase();
  const auto found = database.RunLong("SELECT " + std::string(kColumns) + std::string(kFrom) +
                                          "attempt.id > $1 AND attempt.verification IN ('unverified', "
                                          "'accepted') ORDER BY attempt.id LIMIT $2",
                                      {after, std::int64_t{limit}});
  if (!found.ok()) return found.error();
  std::vector<StoredAttempt> attempts;
  for (const Row& row : found->rows) {
    attempts.push_back(ReadAttempt(row));
    auto metrics = ReadMetrics(database, attempts.back().id);
    if (!metrics.ok()) return metrics.error();
    attempts.back().attempt.metrics = std::move(*metrics);
  }
  return attempts;
}

base::Status RecalcStandings(Database& database, std::int64_t person) {
  static constexpr std::string_view kSteps[] = {
      "DELETE FROM standing WHERE person_id = $1",
      "INSERT INTO standing (task, level, metric, hand, person_id, attempts, latest, latest_ms, lowest, "
      "highest) "
      "SELECT attempt.task, attempt.level, metric.metric, metric.hand, attempt.person_id, COUNT(*), 0, "
      "MAX(attempt.started_ms), MIN(metric.value), MAX(metric.value) FROM metric JOIN attempt ON attempt.id "
      "= "
      "metric.attempt_id WHERE attempt.person_id = $1 AND " TROCAR_COUNTS
      " AND metric.phase = '' AND "
      "metric.tool = '' GROUP BY attempt.task, attempt.level, metric.metric, metric.hand, attempt.person_id",
      "UPDATE standing SET latest = (SELECT metric.value FROM attempt JOIN metric ON metric.attempt_id = "
      "attempt.id "
      "WHERE attempt.person_id = standing.person_id AND attempt.task = standing.task AND attempt.level = "
      "standing.level AND " TROCAR_COUNTS
      " AND metric.metric = standing.metric AND metric.hand = "
      "standing.hand "
      "AND metric.phase = '' AND metric.tool = '' ORDER BY attempt.started_ms DESC, attempt.id DESC LIMIT 1) "
      "WHERE person_id = $1"};
  for (const std::string_view step : kSteps) {
    if (auto done = database.Run(step, {person}); !done.ok()) return done.error();
  }
  return {};
}

base::Result<AttemptPage> ListAttempts(Store& store, const Viewer& viewer, const AttemptFilter& filter,
                                       const std::string& page, int limit) {
  if (limit < 1 || limit > kMostPerPage)
    return base::Error{base::ErrorCode::kUsage,
                       "a page has 1 to " + std::to_string(kMostPerPage) + " attempts"};
  Parameters parameters;
  std::string where = "1 = 1";
  if (!filter.trainee.empty()) {
    const auto person = FindPerson(store, filter.trainee);
    if (!person.ok()) return person.error();
    if (auto may = MaySee(store, viewer, person->id); !may.ok()) return may.error();
    where = "attempt.person_id = " + Put(parameters, person->id);
  } else {
    where += OnlyVisible(viewer, "attempt.person_id", parameters);
  }
  if (!filter.group.empty()) {
    const auto group = FindGroup(store, filter.group);
    if (!group.ok()) return group.error();
    const auto is_large = IsLargeGroup(store.GetDatabase(), group->id);
    if (!is_large.ok()) return is_large.error();
    // the plus keeps both databases from collecting all attempts of all members before they sort them
    where += std::string(" AND ") + (*is_large ? "+" : "") +
             "attempt.person_id IN (SELECT person_id FROM membership WHERE group_id = " +
             Put(parameters, group->id) + ")";
  }
  if (!filter.task.empty()) where += " AND attempt.task = " + Put(parameters, filter.task);
  if (!page.empty()) {
    const auto cursor = ParseCursor(page);
    if (!cursor.ok()) return cursor.error();
    const std::string started = Put(parameters, cursor->started_ms);
    where += " AND (attempt.started_ms, attempt.id) < (" + started + ", " + Put(parameters, cursor->id) + ")";
  }
  // one more than shown tells whether there is another page
  const std::string most = Put(parameters, std::int64_t{limit} + 1);
  const std::string order = " ORDER BY attempt.started_ms DESC, attempt.id DESC";
  // the page is found in an index alone; only its own rows are read
  const auto found = store.GetDatabase().Run("SELECT " + std::string(kColumns) + std::string(kFrom) +
                                                 "attempt.id IN (SELECT attempt.id FROM attempt WHERE " +
                                                 where + order + " LIMIT " + most + ")" + order,
                                             parameters);
  if (!found.ok()) return found.error();
  AttemptPage result;
  for (const Row& row : found->rows) {
    if (result.attempts.size() == static_cast<std::size_t>(limit)) {
      const Row& last = found->rows[static_cast<std::size_t>(limit) - 1];
      result.next = std::to_string(last.Int(kStartedColumn)) + "." + std::to_string(last.Int(0));
      break;
    }
    result.attempts.push_back(ReadAttempt(row));
  }
  return result;
}

base::Result<StoredAttempt> FindAttempt(Store& store, const Viewer& viewer, std::int64_t id) {
  if (auto may = MaySeeAttempt(store, viewer, id); !may.ok()) return may.error();
  Database& database = store.GetDatabase();
  const auto found =
      database.Run("SELECT " + std::string(kColumns) + std::string(kFrom) + "attempt.id = $1", {id});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return Unknown("the store has no such attempt; trocar store attempts lists them");
  StoredAttempt stored = ReadAttempt(found->rows[0]);
  auto metrics = ReadMetrics(database, id);
  if (!metrics.ok()) return metrics.error();
  stored.attempt.metrics = std::move(*metrics);
  return stored;
}

base::Result<std::vector<training::MetricValue>> ReadMetrics(Database& database, std::int64_t attempt) {
  const auto found = database.Run(
      "SELECT metric, hand, phase, tool, value FROM metric WHERE attempt_id = $1 ORDER BY metric, hand, "
      "phase, tool",
      {attempt});
  if (!found.ok()) return found.error();
  std::vector<training::MetricValue> metrics;
  for (const Row& row : found->rows)
    metrics.push_back({row.Text(0), row.Text(1), row.Text(2), row.Real(4), row.Text(3)});
  return metrics;
}

base::Status AddRemark(Store& store, const Viewer& viewer, std::int64_t attempt, std::int64_t tick,
                       std::string_view text) {
  if (viewer.role == Role::kTrainee) return Refused("remarks are made by instructors");
  if (auto may = MaySeeAttempt(store, viewer, attempt); !may.ok()) return may;
  if (tick < 0 || text.empty()) return Invalid("a remark has a text, and a tick from 0 on");
  const std::optional<std::int64_t> author = viewer.person == 0 ? std::nullopt : std::optional(viewer.person);
  const auto added = store.GetDatabase().Run(
      "INSERT INTO remark (attempt_id, author_id, tick, content, written_ms) VALUES ($1, $2, $3, $4, $5)",
      {attempt, OrNull(author), tick, std::string(text), NowMilliseconds()});
  return added.ok() ? base::Status() : added.error();
}

base::Result<std::vector<Remark>> ListRemarks(Store& store, const Viewer& viewer, std::int64_t attempt) {
  if (auto may = MaySeeAttempt(store, viewer, attempt); !may.ok()) return may.error();
  const auto found = store.GetDatabase().Run(
      "SELECT remark.tick, remark.content, person.pseudonym FROM remark LEFT JOIN person ON person.id = "
      "remark.author_id WHERE remark.attempt_id = $1 ORDER BY remark.tick, remark.id",
      {attempt});
  if (!found.ok()) return found.error();
  std::vector<Remark> remarks;
  for (const Row& row : found->rows)
    remarks.push_back({row.Int(0), row.Text(1), row.IsNull(2) ? std::string() : row.Text(2)});
  return remarks;
}

base::Status AddRating(Store& store, const Viewer& viewer, std::int64_t attempt, const Rating& rating) {
  if (viewer.role == Role::kTrainee || viewer.person == 0)
    return Refused("ratings are given by instructors, under their own pseudonym");
  if (auto may = MaySeeAttempt(store, viewer, attempt); !may.ok()) return may;
  if (!IsRatingItem(rating) || rating.value < 1 || rating.value > 5)
    return Invalid("a rating is an item of GOALS or OSATS with 1 to 5");
  const auto added = store.GetDatabase().Run(
      "INSERT INTO rating (attempt_id, rater_id, form, item, value, rated_ms) VALUES ($1, $2, $3, $4, $5, "
      "$6) "
      "ON CONFLICT (attempt_id, rater_id, form, item) DO UPDATE SET value = excluded.value, rated_ms = "
      "excluded.rated_ms",
      {attempt, viewer.person, rating.form, rating.item, std::int64_t{rating.value}, NowMilliseconds()});
  return added.ok() ? base::Status() : added.error();
}

base::Result<std::vector<Rating>> ListRatings(Store& store, const Viewer& viewer, std::int64_t attempt) {
  if (auto may = MaySeeAttempt(store, viewer, attempt); !may.ok()) return may.error();
  const auto found = store.GetDatabase().Run(
      "SELECT rating.form, rating.item, rating.value, person.pseudonym FROM rating JOIN person ON person.id "
      "= "
      "rating.rater_id WHERE rating.attempt_id = $1 ORDER BY person.pseudonym, rating.form, rating.item",
      {attempt});
  if (!found.ok()) return found.error();
  std::vector<Rating> ratings;
  for (const Row& row : found->rows)
    ratings.push_back({row.Text(0), row.Text(1), static_cast<int>(row.Int(2)), row.Text(3)});
  return ratings;
}

base::Status AddCertificate(Store& store, const Viewer& viewer, const Certificate& certificate) {
  if (certificate.key.empty() || certificate.text.empty())
    return Invalid("a certificate has a key and a text");
  Database& database = store.GetDatabase();
  return InTransaction(database, Access::kWrite, [&]() -> base::Status {
    std::optional<std::int64_t> person;
    if (!certificate.trainee.empty()) {
      const auto found = FindPerson(store, certificate.trainee);
      if (!found.ok()) return found.error();
      person = found->id;
    }
    if (auto may = MaySee(store, viewer, person.value_or(-1)); !may.ok()) return may;
    const auto there =
        database.Run("SELECT content FROM certificate WHERE certificate_key = $1", {certificate.key});
    if (!there.ok()) return there.error();
    if (!there->rows.empty()) {
      if (there->rows[0].Text(0) == certificate.text) return {};
      return Invalid("there is another certificate with this key");
    }
    const auto added = database.Run(
        "INSERT INTO certificate (certificate_key, person_id, content, issued_ms) VALUES ($1, $2, $3, $4)",
        {certificate.key, OrNull(person), certificate.text, NowMilliseconds()});
    return added.ok() ? base::Status() : added.error();
  });
}

base::Result<std::vector<Certificate>> ListCertificates(Store& store, const Viewer& viewer,
                                                        std::string_view trainee) {
  const auto person = FindPerson(store, trainee);
  if (!person.ok()) return person.error();
  if (auto may = MaySee(store, viewer, person->id); !may.ok()) return may.error();
  const auto found = store.GetDatabase().Run(
      "SELECT certificate_key, content FROM certificate WHERE person_id = $1 ORDER BY issued_ms, id",
      {person->id});
  if (!found.ok()) return found.error();
  std::vector<Certificate> certificates;
  for (const Row& row : found->rows) certificates.push_back({row.Text(0), std::string(trainee), row.Text(1)});
  return certificates;
}

}  // namespace trocar::store
