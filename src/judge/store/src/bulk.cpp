// SPDX-License-Identifier: Apache-2.0
// Many attempts at once: some dozen rows per statement, and standings counted at the end.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "attempt_rows.h"
#include "database.h"
#include "sql.h"
#include "trocar/store/attempts.h"

namespace trocar::store {
namespace {

constexpr std::size_t kAttemptsAtOnce = 50;
constexpr std::size_t kMetricsAtOnce = 300;

/// "($1, $2), ($3, $4)", filled a row at a time.
class RowsText {
 public:
  void Add(std::vector<Value> row) {
    text_ += text_.empty() ? "(" : ", (";
    for (std::size_t c = 0; c < row.size(); ++c)
      text_ += (c == 0 ? "" : ", ") + Put(parameters_, std::move(row[c]));
    text_ += ")";
    ++count_;
  }
  std::size_t Count() const { return count_; }
  base::Result<Answer> Run(Database& database, const std::string& before, const std::string& after) {
    auto answer = database.Run(before + text_ + after, parameters_);
    *this = {};
    return answer;
  }

 private:
  std::string text_;
  Parameters parameters_;
  std::size_t count_ = 0;
};

class BulkWriter {
 public:
  explicit BulkWriter(Store& store) : store_(store), database_(store.GetDatabase()) {}

  base::Status Add(std::span<const Attempt> attempts) {
    std::map<std::pair<std::string, std::string>, const Attempt*> by_key;
    RowsText rows;
    for (const Attempt& attempt : attempts) {
      if (auto sound = CheckAttempt(attempt); !sound.ok()) return sound;
      const auto started_ms = ParseTime(attempt.started);
      if (!started_ms.ok()) return started_ms.error();
      auto person = FindId(attempt.trainee);
      if (!person.ok()) return person.error();
      if (!by_key.emplace(std::pair(attempt.recording_id, attempt.started), &attempt).second) continue;
      rows.Add({attempt.recording_id,
                attempt.started,
                *started_ms,
                *person,
                attempt.task,
                attempt.level,
                attempt.patient,
                std::to_string(attempt.seed),
                attempt.seconds,
                std::int64_t{attempt.is_completed},
                OrNull(attempt.is_passed),
                OrNull(attempt.score),
                attempt.outcome.empty() ? std::string("{}") : attempt.outcome,
                attempt.recording,
                attempt.program,
                std::string(VerificationName(attempt.mark.state)),
                std::string(WhyName(attempt.mark.why)),
                attempt.mark.program,
                OrNull(attempt.mark.time_ms),
                attempt.mark.claim});
    }
    const auto added =
        rows.Run(database_,
                 "INSERT INTO attempt (recording_id, started, started_ms, person_id, task, level, "
                 "patient, seed, seconds, completed, passed, score, outcome, recording_path, program, "
                 "verification, verification_why, verified_by, verified_ms, claim) "
                 "VALUES ",
                 " ON CONFLICT (recording_id, started) DO NOTHING RETURNING id, recording_id, started");
    if (!added.ok()) return added.error();
    for (const Row& row : added->rows) {
      const Attempt& attempt = *by_key.at({row.Text(1), row.Text(2)});
      if (!attempt.trainee.empty() && attempt.CountsAsCompleted()) raised_.insert(attempt.trainee);
      for (const training::MetricValue& m : ListMetrics(attempt)) {
        metrics_.Add({row.Int(0), m.metric, m.hand, m.phase, m.tool, m.value});
        if (metrics_.Count() < kMetricsAtOnce) continue;
        if (auto written = WriteMetrics(); !written.ok()) return written;
      }
    }
    added_ += static_cast<std::int64_t>(added->rows.size());
    return {};
  }

  base::Result<std::int64_t> Finish() {
    if (metrics_.Count() > 0) {
      if (auto written = WriteMetrics(); !written.ok()) return written.error();
    }
    for (const std::string& trainee : raised_) {
      if (auto counted = RecalcStandings(database_, std::get<std::int64_t>(people_.at(trainee)));
          !counted.ok())
        return counted.error();
    }
    return added_;
  }

 private:
  base::Status WriteMetrics() {
    const auto written = metrics_.Run(
        database_, "INSERT INTO metric (attempt_id, metric, hand, phase, tool, value) VALUES ", "");
    return written.ok() ? base::Status() : written.error();
  }

  base::Result<Value> FindId(const std::string& trainee) {
    if (trainee.empty()) return Value{};
    const auto known = people_.find(trainee);
    if (known != people_.end()) return known->second;
    const auto person = FindPerson(store_, trainee);
    if (!person.ok()) return person.error();
    return people_.emplace(trainee, person->id).first->second;
  }

  Store& store_;
  Database& database_;
  RowsText metrics_;
  std::map<std::string, Value> people_;
  std::set<std::string> raised_;
  std::int64_t added_ = 0;
};

}  // namespace

base::Result<std::int64_t> AddAttempts(Store& store, const Viewer& viewer,
                                       std::span<const Attempt> attempts) {
  if (auto may = MayManage(viewer); !may.ok()) return may.error();
  return InTransaction(store.GetDatabase(), Access::kWrite, [&]() -> base::Result<std::int64_t> {
    BulkWriter writer(store);
    for (std::size_t begin = 0; begin < attempts.size(); begin += kAttemptsAtOnce) {
      const auto part = attempts.subspan(begin, std::min(kAttemptsAtOnce, attempts.size() - begin));
      if (auto added = writer.Add(part); !added.ok()) return added.error();
    }
    return writer.Finish();
  });
}

}  // namespace trocar::store
