// SPDX-License-Identifier: Apache-2.0
// PostgreSQL over libpqxx 6 and 7. libpqxx waits for a server for ever; here a watch ends the connection of one that is silent.
#include <sys/socket.h>

#include <charconv>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <pqxx/pqxx>
#include <thread>
#include <unordered_map>
#include <utility>

#include "database.h"
#include "postgres_part.h"

namespace trocar::store {
namespace {

using base::ErrorCode;

constexpr double kLongSeconds = 3600;  // for what rewrites tables

/// Shuts a socket down when what was armed takes longer than it may.
class SilenceWatch {
 public:
  SilenceWatch() : thread_([this] { Run(); }) {}
  ~SilenceWatch() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  SilenceWatch(const SilenceWatch&) = delete;
  SilenceWatch& operator=(const SilenceWatch&) = delete;

  void Arm(int socket, double seconds) {
    {
      const std::lock_guard lock(mutex_);
      socket_ = socket;
      until_ = std::chrono::steady_clock::now() +
               std::chrono::milliseconds(static_cast<std::int64_t>(1000 * seconds));
    }
    changed_.notify_all();
  }
  void Disarm() {
    const std::lock_guard lock(mutex_);
    socket_ = -1;
  }
  bool HasFired() {
    const std::lock_guard lock(mutex_);
    return has_fired_;
  }

 private:
  void Run() {
    std::unique_lock lock(mutex_);
    while (!is_ending_) {
      if (socket_ < 0) {
        changed_.wait(lock);
      } else if (std::chrono::steady_clock::now() < until_) {
        changed_.wait_until(lock, until_);
      } else {
        // the thread that waits on it sees the end of the connection
        ::shutdown(socket_, SHUT_RDWR);
        has_fired_ = true;
        socket_ = -1;
      }
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  int socket_ = -1;
  std::chrono::steady_clock::time_point until_;
  bool has_fired_ = false, is_ending_ = false;
  std::thread thread_;  // last: it uses what stands before
};

base::Error Away(const std::string& why) {
  return {
      ErrorCode::kStoreAway,
      "the store's server: " + why +
          "; check that it runs and the network, then run trocar store deliver. Attempts wait in the spool"};
}

/// The server's own words may hold what was to be stored: only its code is shown. Source: PostgreSQL, appendix A.
base::Error MakeError(const std::string& state) {
  const std::string of = "the store's server (SQLSTATE " + state + "): ";
  const std::string family = state.substr(0, 2);
  if (state == "25006")
    return {
        ErrorCode::kStoreReadOnly,
        of + "it takes nothing new, as a standby does; connect to the primary. Attempts wait in the spool"};
  if (state == "42501" || family == "28")
    return {ErrorCode::kStoreReadOnly,
            of + "this account has not the right; ask the database's administrator for it"};
  if (state == "55P03" || state == "57014" || state == "40001" || state == "40P01")
    return {ErrorCode::kStoreBusy, of + "it is busy or locked; try again, or look for the program that holds "
                                        "it. Attempts wait in the spool"};
  if (state == "53100")
    return {ErrorCode::kStoreFull, of + "its disk is full; free space there. Attempts wait in the spool"};
  if (family == "08" || family == "53" || family == "57")
    return Away("it is going down or takes no connection");
  if (family == "XX" || family == "58")
    return {ErrorCode::kStoreDamaged, of + "it reports damage; see the server's log, and restore a backup"};
  if (family == "23" || family == "22")
    return {ErrorCode::kStoreInvalid, of + "what shall be stored contradicts what is there"};
  if (family == "42" || family == "3D" || family == "3F")
    return {
        ErrorCode::kStoreSchema,
        of + "the tables are not those of a store; check the database's name, or run trocar store migrate"};
  return Away("error " + state);
}

/// The shortest that is the same number; not by the user's language, as printf.
std::string NumberText(double value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

class PostgresDatabase final : public Database {
 public:
  PostgresDatabase(const std::string& options, double answer_seconds)
      : connection_(options), answer_seconds_(answer_seconds) {
#if PQXX_VERSION_MAJOR < 7
    // a silent new connection in the middle of a transaction would lose its first half
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // there is no other way in libpqxx 6
    connection_.inhibit_reactivation(true);
#pragma GCC diagnostic pop
#endif
    work_ = std::make_unique<pqxx::nontransaction>(connection_);
  }
  ~PostgresDatabase() override {
    watch_.Arm(connection_.sock(), answer_seconds_);  // saying goodbye to a silent server
    work_.reset();
  }

  Dialect GetDialect() const override {
    return Dialect::kPostgres;
  }
  bool IsInTransaction() const override {
    return is_in_transaction_;
  }

  base::Result<Answer> Run(std::string_view sql, const Parameters& parameters) override {
    return RunFor(answer_seconds_, sql, parameters);
  }

  base::Result<Answer> RunLong(std::string_view sql, const Parameters& parameters) override {
    if (auto set = RunPlain("SET statement_timeout = 0"); !set.ok()) return set.error();
    auto answer = RunFor(kLongSeconds, sql, parameters);
    // where the statement failed within a transaction, its end restores the timeout
    if (answer.ok()) {
      if (auto set = SetTimeouts(); !set.ok()) return set.error();
    }
    return answer;
  }

  base::Result<Answer> RunFor(double seconds, std::string_view sql, const Parameters& parameters) {
    std::vector<std::string> texts;
    texts.reserve(parameters.size());
    std::vector<const char*> places;
    places.reserve(parameters.size());
    for (const Value& value : parameters) {
      if (value.index() == 0) {
        places.push_back(nullptr);
        continue;
      }
      if (const auto* whole = std::get_if<std::int64_t>(&value))
        texts.push_back(std::to_string(*whole));
      else if (const auto* real = std::get_if<double>(&value))
        texts.push_back(NumberText(*real));
      else
        texts.push_back(EncodeText(std::get<std::string>(value)));
      places.push_back(texts.back().c_str());
    }
    return Ask(seconds, [&] { return ReadAnswer(Execute(std::string(sql), places)); });
  }

  base::Status RunScript(std::string_view sql) override {
    const auto done = Ask(kLongSeconds, [&] {
      work_->exec(std::string(sql));
      return Answer{};
    });
    return done.ok() ? base::Status() : done.error();
  }

  base::Status Begin(Access access) override {
    auto begun =
        RunPlain(access == Access::kRead ? "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY" : "BEGIN");
    is_in_transaction_ = begun.ok();
    return begun;
  }
  base::Status Commit() override {
    is_in_transaction_ = false;
    return RunPlain("COMMIT");
  }
  void Rollback() override {
    if (!std::exchange(is_in_transaction_, false)) return;
    (void)RunPlain("ROLLBACK").ok();  // where it fails the connection is gone, and with it the transaction
  }

  base::Status Purge() override {
    // to an account that is not theirs, the server skips tables with no more than a warning
    const auto foreign =
        Run("SELECT COUNT(*) FROM pg_class WHERE relname IN ('person', 'attempt', 'remark') AND "
            "relnamespace = CAST(current_schema() AS regnamespace) AND NOT pg_has_role(relowner, "
            "'USAGE')",
            {});
    if (!foreign.ok()) return foreign.error();
    if (foreign->rows[0].Int(0) > 0)
      return base::Error{
          ErrorCode::kStoreReadOnly,
          "this account does not own the store's tables, so that what was deleted stays in their "
          "files; let their owner run trocar store tidy"};
    // FULL writes the tables anew, without what was deleted; pg_statistic holds samples of columns
    for (const char* step :
         {"SET statement_timeout = 0", "VACUUM (FULL, ANALYZE) person",
          "VACUUM (FULL, ANALYZE) training_group", "VACUUM (FULL, ANALYZE) membership",
          "VACUUM (FULL, ANALYZE) assignment", "VACUUM (FULL, ANALYZE) attempt",
          "VACUUM (FULL, ANALYZE) metric", "VACUUM (FULL, ANALYZE) standing", "VACUUM (FULL, ANALYZE) rating",
          "VACUUM (FULL, ANALYZE) remark", "VACUUM (FULL, ANALYZE) certificate", "RESET statement_timeout"}) {
      if (auto status = RunScript(step); !status.ok()) return status;
    }
    return SetTimeouts();
  }

  base::Status SetTimeouts() {
    const auto milliseconds = [](double seconds) {
      return std::to_string(static_cast<std::int64_t>(1000 * seconds));
    };
    return RunPlain("SET client_min_messages = warning; SET client_encoding = 'UTF8'; SET lock_timeout = " +
                    milliseconds(busy_seconds) +
                    "; SET statement_timeout = " + milliseconds(0.9 * answer_seconds_));
  }

  double busy_seconds = 2;

 private:
  base::Status RunPlain(const std::string& sql) {
    const auto done = Ask(answer_seconds_, [&] {
      work_->exec(sql);
      return Answer{};
    });
    return done.ok() ? base::Status() : done.error();
  }

  /// The one place that catches what libpqxx throws.
  template <typename Question>
  base::Result<Answer> Ask(double seconds, const Question& question) {
    if (watch_.HasFired() || is_lost_) return Away("the connection was lost");
    watch_.Arm(connection_.sock(), seconds);
    try {
      Answer answer = question();
      watch_.Disarm();
      return answer;
    } catch (const pqxx::broken_connection&) {
      // named below
    } catch (const pqxx::sql_error& error) {
      watch_.Disarm();
      if (!error.sqlstate().empty() && !watch_.HasFired()) {
        if (error.sqlstate().starts_with("57P")) is_lost_ = true;
        return MakeError(error.sqlstate());
      }
    } catch (const std::exception&) {
      // named below
    }
    watch_.Disarm();
    is_lost_ = true;
    return Away(watch_.HasFired() ? "it has not answered for " + NumberText(seconds) + " s"
                                  : "the connection was lost");
  }

  pqxx::result Execute(const std::string& sql, const std::vector<const char*>& places) {
    // a server tells names apart by their first 63 bytes
    const auto [prepared, is_new] = prepared_.try_emplace(sql, "q" + std::to_string(prepared_.size()));
    const std::string& name = prepared->second;
    if (is_new) connection_.prepare(name, sql);
#if PQXX_VERSION_MAJOR < 7
    return work_->exec_prepared(name, pqxx::prepare::make_dynamic_params(places.begin(), places.end()));
#else
    pqxx::params values;
    for (const char* place : places) place == nullptr ? values.append() : values.append(std::string(place));
    return work_->exec_prepared(name, values);
#endif
  }

  static Answer ReadAnswer(const pqxx::result& result) {
    constexpr pqxx::oid kInt8 = 20, kInt2 = 21, kInt4 = 23, kFloat4 = 700, kFloat8 = 701;
    Answer answer;
    answer.changed = static_cast<std::int64_t>(result.affected_rows());
    answer.rows.reserve(static_cast<std::size_t>(result.size()));
    for (const auto& from : result) {
      Row row;
      row.values.reserve(static_cast<std::size_t>(from.size()));
      for (const auto& field : from) {
        if (field.is_null()) {
          row.values.emplace_back(std::monostate{});
          continue;
        }
        const char* begin = field.c_str();
        const char* end = begin + field.size();
        const pqxx::oid type = field.type();
        if (type == kInt8 || type == kInt4 || type == kInt2) {
          std::int64_t whole = 0;
          std::from_chars(begin, end, whole);
          row.values.emplace_back(whole);
        } else if (type == kFloat8 || type == kFloat4) {
          double real = 0;
          std::from_chars(begin, end, real);
          row.values.emplace_back(real);
        } else {
          row.values.emplace_back(DecodeText({begin, field.size()}));
        }
      }
      answer.rows.push_back(std::move(row));
    }
    return answer;
  }

  pqxx::connection connection_;
  double answer_seconds_;
  SilenceWatch watch_;
  std::unique_ptr<pqxx::nontransaction> work_;
  std::unordered_map<std::string, std::string> prepared_;  // text to name
  bool is_in_transaction_ = false, is_lost_ = false;
};

OpenedDatabase Connect(const std::string& url, double busy_seconds, double answer_seconds) {
  // the shortest that libpq takes is 2 s
  const auto connect_seconds = static_cast<int>(std::max(2.0, answer_seconds));
  const std::string options = url + (url.find('?') == std::string::npos ? "?" : "&") +
                              "connect_timeout=" + std::to_string(connect_seconds) +
                              "&application_name=trocar";
  std::unique_ptr<PostgresDatabase> database;
  try {
    database = std::make_unique<PostgresDatabase>(options, answer_seconds);
  } catch (const std::exception&) {
    // libpq's words would show the address with its account
    return Away("it takes no connection: no server at this address, no such database, or not this account");
  }
  database->busy_seconds = busy_seconds;
  if (auto set = database->SetTimeouts(); !set.ok()) return set.error();
  const auto encoding = database->Run("SHOW server_encoding", {});
  if (!encoding.ok()) return encoding.error();
  if (encoding->rows[0].Text(0) != "UTF8")
    return base::Error{
        ErrorCode::kStoreSchema,
        "the database does not hold UTF-8; make one with: createdb --encoding=UTF8 --template=template0"};
  return std::unique_ptr<Database>(std::move(database));
}

}  // namespace
}  // namespace trocar::store

extern "C" __attribute__((visibility("default"))) void TrocarOpenPostgres(
    const std::string& url, double busy_seconds, double answer_seconds,
    trocar::store::OpenedDatabase& opened) {
  opened = trocar::store::Connect(url, busy_seconds, answer_seconds);
}
