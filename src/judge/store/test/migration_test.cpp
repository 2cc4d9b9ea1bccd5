// SPDX-License-Identifier: Apache-2.0
// From an empty database, and from every version that ever was, to today's tables.
#include <atomic>
#include <memory>
#include <thread>

#include "schema.h"
#include "store_test.h"
#include "trocar/store/maintenance.h"

namespace trocar::store {
namespace {

class MigrationOver : public StoreTest {
 protected:
  void SetUp() override { place_ = MakePlace("old"); }
  base::Result<std::unique_ptr<Database>> OpenPlain() {
    return place_.IsPostgres() ? OpenPostgres(place_.url, 2, 10) : OpenSqlite(place_.url, 2);
  }
};
INSTANTIATE_OVER_DATABASES(MigrationOver);

TEST_P(MigrationOver, MakesAnEmptyDatabaseAStore) {
  StoreSettings look;
  look.only_look = true;
  EXPECT_FALSE(Store::Open(place_, look).ok()) << "who only looks makes nothing";
  Reopen();
  EXPECT_EQ(Get(Open().ReadVersion()), Migrations().back().version);
  EXPECT_GOOD(Store::Open(place_, look));
}

TEST(Migrations, AreNumberedFromOneWithoutGaps) {
  int expected = 1;
  for (const Migration& step : Migrations()) EXPECT_EQ(step.version, expected++);
}

// test/version1.*.sql is what `sqlite3 .dump` and `pg_dump --inserts` wrote of a store of version 1. It is kept for ever; each later
// version adds its own.
TEST_P(MigrationOver, BringsEveryPastVersionUpToDate) {
  for (int version = 1; version <= Migrations().back().version; ++version) {
    SCOPED_TRACE(version);
    if (version > 1) place_ = MakePlace("old" + std::to_string(version));
    const std::string kind = place_.IsPostgres() ? "postgres" : "sqlite";
    const std::string sql = ReadAll(std::string(TROCAR_SOURCE_DIR) + "/src/judge/store/test/version" +
                                    std::to_string(version) + "." + kind + ".sql");
    ASSERT_FALSE(sql.empty()) << "there is no store of version " << version;
    EXPECT_GOOD(Get(OpenPlain())->RunScript(sql));
    Reopen();
    EXPECT_EQ(Get(Open().ReadVersion()), Migrations().back().version);
    EXPECT_GOOD(Verify(Open()));
    const StoreCounts counts = Get(CountAll(Open(), kOwner));
    EXPECT_EQ(counts.people, 2);
    EXPECT_EQ(counts.attempts, 3);
    const auto page = Get(ListAttempts(Open(), kOwner, {"T-VERS1N", "", ""}));
    ASSERT_EQ(page.attempts.size(), 2u);
    EXPECT_EQ(Get(FindAttempt(Open(), kOwner, page.attempts[0].id)).attempt.metrics.size(), 4u);
    // and it goes on from there
    EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(500, "T-VERS1N"))));
    EXPECT_GOOD(Verify(Open()));
  }
}

TEST_P(MigrationOver, DoesAllStepsOrNone) {
  const std::string first(Migrations()[0].sql);
  const Migration good[] = {
      {1, first}, {2, "ALTER TABLE attempt ADD COLUMN room {text};\nUPDATE attempt SET room = 'a'"}};
  const Migration bad[] = {{1, first},
                           {2, "ALTER TABLE attempt ADD COLUMN room {text};\nUPDATE attempt SET room = 'a'"},
                           {3, "ALTER TABLE attempt ADD COLUMN floor {text};\nUPDATE nothing SET x = 1"}};
  auto database = Get(OpenPlain());
  EXPECT_EQ(Get(Migrate(*database, {good, 1})), 0);
  EXPECT_FALSE(Migrate(*database, bad).ok());
  EXPECT_EQ(Get(ReadSchemaVersion(*database)), 1);
  EXPECT_FALSE(database->Run("SELECT room FROM attempt").ok()) << "half a migration is left";
  EXPECT_EQ(Get(Migrate(*database, good)), 1);
  EXPECT_EQ(Get(ReadSchemaVersion(*database)), 2);
  EXPECT_TRUE(database->Run("SELECT room FROM attempt").ok());
  EXPECT_EQ(Get(Migrate(*database, good)), 2) << "again does nothing";
  EXPECT_CODE(Migrate(*database, {good, 1}), kStoreSchema);
}

TEST_P(MigrationOver, IsDoneByOneProgramOfMany) {
  std::vector<std::thread> threads;
  std::atomic<int> opened = 0;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      const auto store = Store::Open(place_);
      EXPECT_TRUE(store.ok()) << store.error().Text();
      opened += store.ok() ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(opened, 8);
}

}  // namespace
}  // namespace trocar::store
