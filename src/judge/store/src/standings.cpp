// SPDX-License-Identifier: Apache-2.0
// How a value compares with a group, from one row per trainee, task and metric that AddAttempt keeps up to date.
#include <algorithm>

#include "database.h"
#include "sql.h"
#include "trocar/store/attempts.h"

namespace trocar::store {
namespace {

base::Status CheckKey(const MetricKey& key) {
  if (!key.phase.empty() || !key.tool.empty())
    return Invalid("trainees are compared by numbers of whole attempts: leave out phase and tool");
  return {};
}

std::string_view ColumnOf(Counted counted) {
  static constexpr std::string_view kColumns[] = {"standing.latest", "standing.lowest", "standing.highest"};
  return kColumns[static_cast<std::size_t>(counted)];
}

/// " FROM ... WHERE ..." of a group's trainees in one number.
base::Result<std::string> FromGroup(Store& store, const Viewer& viewer, std::string_view group,
                                    const MetricKey& key, Parameters& parameters) {
  if (auto sound = CheckKey(key); !sound.ok()) return sound.error();
  std::string from = " FROM standing";
  if (group.empty()) {
    if (auto may = MayManage(viewer); !may.ok()) return may.error();
  } else {
    const auto found = FindGroup(store, group);
    if (!found.ok()) return found.error();
    if (viewer.role != Role::kAdministrator) {
      const auto own = store.GetDatabase().Run(
          "SELECT 1 FROM membership WHERE group_id = $1 AND person_id = $2", {found->id, viewer.person});
      if (!own.ok()) return own.error();
      if (own->rows.empty()) return Refused("only members of a group see how it does");
    }
    from += " JOIN membership ON membership.person_id = standing.person_id AND membership.group_id = " +
            Put(parameters, found->id);
  }
  from += " WHERE standing.task = " + Put(parameters, key.task);
  from += " AND standing.level = " + Put(parameters, key.level);
  from += " AND standing.metric = " + Put(parameters, key.metric);
  from += " AND standing.hand = " + Put(parameters, key.hand);
  return from;
}

base::Status CheckNumber(const Viewer& viewer, std::int64_t trainees) {
  if (viewer.role == Role::kTrainee && trainees < kFewestTrainees)
    return Refused("with fewer than " + std::to_string(kFewestTrainees) +
                   " trainees in the comparison it would show whose values they are");
  return {};
}

}  // namespace

base::Result<std::optional<Standing>> FindStanding(Store& store, const Viewer& viewer,
                                                   std::string_view trainee, const MetricKey& key) {
  if (auto sound = CheckKey(key); !sound.ok()) return sound.error();
  const auto person = FindPerson(store, trainee);
  if (!person.ok()) return person.error();
  if (auto may = MaySee(store, viewer, person->id); !may.ok()) return may.error();
  const auto found = store.GetDatabase().Run(
      "SELECT attempts, latest, lowest, highest FROM standing WHERE task = $1 AND level = $2 AND metric = $3 "
      "AND "
      "hand = $4 AND person_id = $5",
      {key.task, key.level, key.metric, key.hand, person->id});
  if (!found.ok()) return found.error();
  if (found->rows.empty()) return std::optional<Standing>();
  const Row& row = found->rows[0];
  return std::optional(Standing{row.Int(0), row.Real(1), row.Real(2), row.Real(3)});
}

base::Result<Percentile> CalcPercentile(Store& store, const Viewer& viewer, std::string_view group,
                                        const MetricKey& key, double value, Counted counted) {
  Parameters parameters{value};
  const auto from = FromGroup(store, viewer, group, key, parameters);
  if (!from.ok()) return from.error();
  const std::string column(ColumnOf(counted));
  const auto found = store.GetDatabase().Run("SELECT COALESCE(SUM(CASE WHEN " + column +
                                                 " < $1 THEN 1 ELSE 0 END), 0), COALESCE(SUM(CASE WHEN " +
                                                 column + " = $1 THEN 1 ELSE 0 END), 0), COUNT(*)" + *from,
                                             parameters);
  if (!found.ok()) return found.error();
  const Row& row = found->rows[0];
  const Percentile percentile{row.Int(0), row.Int(1), row.Int(2)};
  if (auto enough = CheckNumber(viewer, percentile.trainees); !enough.ok()) return enough.error();
  return percentile;
}

base::Result<std::vector<double>> ListGroupValues(Store& store, const Viewer& viewer, std::string_view group,
                                                  const MetricKey& key, Counted counted) {
  Parameters parameters;
  const auto from = FromGroup(store, viewer, group, key, parameters);
  if (!from.ok()) return from.error();
  const auto found = store.GetDatabase().Run("SELECT " + std::string(ColumnOf(counted)) + *from, parameters);
  if (!found.ok()) return found.error();
  if (auto enough = CheckNumber(viewer, static_cast<std::int64_t>(found->rows.size())); !enough.ok())
    return enough.error();
  std::vector<double> values;
  values.reserve(found->rows.size());
  for (const Row& row : found->rows) values.push_back(row.Real(0));
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace trocar::store
