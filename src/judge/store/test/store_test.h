// SPDX-License-Identifier: Apache-2.0
/// \file store_test.h  A test that runs over both databases, each time with an empty one.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "postgres_server.h"
#include "trocar/base/state_hash.h"
#include "trocar/store/attempts.h"
#include "trocar/store/people.h"
#include "trocar/store/spool.h"
#include "trocar/store/store.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::store {

inline const Viewer kOwner = Viewer::Owner();

/// The value of a result; where it is none, the test fails with its error.
template <typename T>
T Get(base::Result<T> result) {
  if (!result.ok()) {
    ADD_FAILURE() << result.error().Text();
    return T{};
  }
  return std::move(*result);
}

#define EXPECT_GOOD(expression)                                                                       \
  do {                                                                                                \
    const auto& status_ = (expression);                                                               \
    EXPECT_TRUE(status_.ok()) << #expression << ": " << (status_.ok() ? "" : status_.error().Text()); \
  } while (false)

#define EXPECT_CODE(expression, expected)                                                 \
  do {                                                                                    \
    const auto& status_ = (expression);                                                   \
    ASSERT_FALSE(status_.ok()) << #expression << " was allowed";                          \
    EXPECT_EQ(status_.error().code, base::ErrorCode::expected) << status_.error().Text(); \
  } while (false)

/// A different attempt for each number; a day has 1000 of them.
inline Attempt MakeAttempt(int number, const std::string& trainee, const std::string& task = "peg_transfer") {
  Attempt attempt;
  attempt.recording_id = base::HashText(0x1000 + static_cast<std::uint64_t>(number));
  char started[40];
  std::snprintf(started, sizeof started, "2026-%02d-%02dT%02d:%02d:%02d+01:00", 1 + number / 28000 % 12,
                1 + number / 1000 % 28, number % 1000 / 60 % 24, number % 60, number % 7);
  attempt.started = started;
  attempt.trainee = trainee;
  attempt.task = task;
  attempt.level = "easy";
  attempt.seed = 7;
  attempt.seconds = 60 + number % 13;
  attempt.is_completed = true;
  attempt.score = number % 100;
  attempt.outcome = R"({"seconds":60})";
  attempt.program = "0.1.0";
  attempt.mark = {Verification::kVerified, WhyUnverified::kNone, "0.1.0", 1'700'000'000'000, ""};
  attempt.metrics = {{"path_length", "left", "", 1.5 + number % 17, ""},
                     {"path_length", "right", "", 2.5, ""},
                     {"path_length", "right", "transfer", 0.5, "grasper"}};
  return attempt;
}

inline std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Files below a folder whose bytes hold the text.
inline std::vector<std::string> FilesWith(const std::filesystem::path& folder, const std::string& text) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().filename().string().find(text) != std::string::npos) found.push_back(entry.path());
    if (entry.is_regular_file() && ReadAll(entry.path()).find(text) != std::string::npos)
      found.push_back(entry.path());
  }
  return found;
}

enum class Kind { kSqlite, kPostgres };

class StoreTest : public testing::TestWithParam<Kind> {
 protected:
  void SetUp() override {
    place_ = MakePlace("store");
    auto opened = OpenResult();
    ASSERT_TRUE(opened.ok()) << opened.error().Text();
    store_.emplace(std::move(*opened));
  }
  void TearDown() override { store_.reset(); }

  /// Another empty store of the same kind.
  Place MakePlace(const std::string& name) { return MakePlace(GetParam(), name); }
  Place MakePlace(Kind kind, const std::string& name) {
    Place place;
    place.folder = folder_.Path() / (name + ".files");
    place.url = folder_.Path() / (name + ".sqlite");
    if (kind == Kind::kPostgres) {
      PostgresServer& server = PostgresServer::Get();
      if (!server.IsRunning()) {
        ADD_FAILURE() << "no PostgreSQL server could be started: " << server.Trouble();
        return place;
      }
      const std::string database =
          name + "_" + std::to_string(::getpid()) + "_" + std::to_string(++databases_);
      EXPECT_GOOD(server.Administer("CREATE DATABASE " + database));
      place.url = server.Url(database);
      database_ = database;
    }
    return place;
  }
  base::Result<Store> OpenResult(StoreSettings settings = {}) { return Store::Open(place_, settings); }
  Store& Reopen() {
    store_.reset();
    auto opened = OpenResult();
    EXPECT_GOOD(opened);
    if (opened.ok()) store_.emplace(std::move(*opened));
    return *store_;
  }
  Store& Open() { return *store_; }
  std::int64_t Count(const std::string& from) {
    const auto answer = Open().GetDatabase().Run("SELECT COUNT(*) FROM " + from);
    return answer.ok() ? answer->rows[0].Int(0) : -1;
  }
  std::string Add(Role role, const std::string& pseudonym = "") {
    return Get(AddPerson(Open(), kOwner, role, pseudonym)).pseudonym;
  }

  test::TemporaryFolder folder_;
  Place place_;
  std::string database_;  // of the newest place, on the server
  std::optional<Store> store_;

 private:
  static inline int databases_ = 0;
};

inline std::string KindName(const testing::TestParamInfo<Kind>& info) {
  return info.param == Kind::kSqlite ? "Sqlite" : "Postgres";
}

#define INSTANTIATE_OVER_DATABASES(suite) \
  INSTANTIATE_TEST_SUITE_P(Databases, suite, testing::Values(Kind::kSqlite, Kind::kPostgres), KindName)

}  // namespace trocar::store
