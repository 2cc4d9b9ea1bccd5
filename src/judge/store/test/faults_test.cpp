// SPDX-License-Identifier: Apache-2.0
// A database that is locked, full, away, read-only, damaged, deleted or of another schema: each with its code, and nothing lost.
#include <fcntl.h>
#include <linux/capability.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>

#include "schema.h"
#include "store_test.h"
#include "trocar/host/clock.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

class SqliteFaults : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    if (store_) trainee_ = Add(Role::kTrainee);
  }
  /// Adds attempts [first, last) through the spool.
  void Deliver(int first, int last) {
    for (int i = first; i < last; ++i) EXPECT_GOOD(spool().Keep(MakeAttempt(i, trainee_)));
    const DeliveryReport report = spool().Deliver(Open());
    EXPECT_FALSE(report.failure) << report.failure->Text();
  }
  Spool spool() { return Spool(place_); }
  void Overwrite(std::int64_t at, const std::string& bytes) {
    const int file = ::open(place_.url.c_str(), O_WRONLY);
    ASSERT_EQ(::pwrite(file, bytes.data(), bytes.size(), at), static_cast<ssize_t>(bytes.size()));
    ::close(file);
  }
  void CloseStore() {
    EXPECT_TRUE(Open().GetDatabase().Run("PRAGMA wal_checkpoint(TRUNCATE)").ok());
    store_.reset();
  }

  std::string trainee_;
};
INSTANTIATE_TEST_SUITE_P(Databases, SqliteFaults, testing::Values(Kind::kSqlite), KindName);

TEST_P(SqliteFaults, LockedByAnotherProgram) {
  auto other = Get(OpenSqlite(place_.url, 2));
  EXPECT_GOOD(other->Begin(Access::kWrite));
  const host::Stopwatch watch;
  EXPECT_CODE(AddAttempt(Open(), MakeAttempt(1, trainee_)), kStoreBusy);
  EXPECT_GE(watch.Seconds(), 1.5);
  EXPECT_LT(watch.Seconds(), 10);
  const KeepReport report = Get(KeepAttempt(place_, MakeAttempt(1, trainee_), {0.1}));
  EXPECT_FALSE(report.is_in_store);
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreBusy);
  other->Rollback();
  EXPECT_EQ(spool().Deliver(Open()).added, 1);
}

TEST_P(SqliteFaults, Full) {
  const auto limit = [&](const std::string& pages) {
    return Open().GetDatabase().Run("PRAGMA max_page_count=" + pages).ok();
  };
  ASSERT_TRUE(limit("1"));  // no page more than there are
  int added = 0;
  std::optional<base::Error> failure;
  for (int i = 0; i < 2000 && !failure; ++i) {
    EXPECT_GOOD(spool().Keep(MakeAttempt(i, trainee_)));
    const DeliveryReport report = spool().Deliver(Open());
    added += report.added;
    failure = report.failure;
  }
  ASSERT_TRUE(failure.has_value());
  EXPECT_EQ(failure->code, base::ErrorCode::kStoreFull) << failure->Text();
  EXPECT_THAT(failure->message, HasSubstr("free space"));
  EXPECT_EQ(spool().CountWaiting(), 1u);
  EXPECT_EQ(Count("attempt"), added);
  ASSERT_TRUE(limit("1000000"));
  EXPECT_EQ(spool().Deliver(Open()).added, 1);
  EXPECT_GOOD(Verify(Open()));
}

/// Nothing is read-only to root: as long as it lives, this thread has no more rights to files than any other account.
class OrdinaryRights {
 public:
  OrdinaryRights() {
    if (::geteuid() != 0) return;
    EXPECT_EQ(::syscall(SYS_capget, &header_, before_.data()), 0);
    auto fewer = before_;
    constexpr unsigned kRights[] = {CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH, CAP_FOWNER};
    for (const unsigned right : kRights) fewer[CAP_TO_INDEX(right)].effective &= ~CAP_TO_MASK(right);
    EXPECT_EQ(::syscall(SYS_capset, &header_, fewer.data()), 0);
  }
  ~OrdinaryRights() {
    if (::geteuid() == 0) {
      EXPECT_EQ(::syscall(SYS_capset, &header_, before_.data()), 0);
    }
  }
  OrdinaryRights(const OrdinaryRights&) = delete;
  OrdinaryRights& operator=(const OrdinaryRights&) = delete;

 private:
  __user_cap_header_struct header_{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> before_{};
};

TEST_P(SqliteFaults, CannotBeWritten) {
  Deliver(0, 1);
  CloseStore();
  const test::TemporaryFolder elsewhere;
  const Place place{place_.url, elsewhere.Path() / "files"};
  ASSERT_EQ(::chmod(place_.url.c_str(), 0444), 0);
  ASSERT_EQ(::chmod(folder_.Path().c_str(), 0555), 0);
  {
    const OrdinaryRights rights;
    ASSERT_LT(::open(place_.url.c_str(), O_WRONLY), 0) << "the test shows nothing";
    const KeepReport report = Get(KeepAttempt(place, MakeAttempt(1, trainee_)));
    EXPECT_FALSE(report.is_in_store);
    ASSERT_TRUE(report.failure.has_value());
    EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreReadOnly) << report.failure->Text();
    EXPECT_EQ(Spool(place).CountWaiting(), 1u);
  }
  ASSERT_EQ(::chmod(folder_.Path().c_str(), 0755), 0);
  ASSERT_EQ(::chmod(place_.url.c_str(), 0600), 0);
  Reopen();
  EXPECT_EQ(Spool(place).Deliver(Open()).added, 1);
}

TEST_P(SqliteFaults, DeletedWhileItIsOpen) {
  Deliver(0, 5);
  EXPECT_GOOD(BackUp(Open(), kOwner));
  Deliver(5, 8);
  for (const char* part : {"", "-wal", "-shm"}) fs::remove(place_.url + part);
  EXPECT_GOOD(spool().Keep(MakeAttempt(8, trainee_)));
  const DeliveryReport report = spool().Deliver(Open());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreAway);
  Reopen();
  EXPECT_THAT(Open().Rebuilt(), HasSubstr("built again from the backup"));
  EXPECT_EQ(spool().Deliver(Open()).added, 1);
  EXPECT_EQ(Count("attempt"), 9);
  EXPECT_GOOD(Verify(Open()));
}

TEST_P(SqliteFaults, DamagedIsSetAsideAndBuiltAgain) {
  Deliver(0, 40);
  EXPECT_GOOD(AddGroup(Open(), kOwner, "evening"));
  EXPECT_GOOD(BackUp(Open(), kOwner));
  Deliver(40, 60);
  CloseStore();
  Overwrite(4096, std::string(3 * 4096, '\x5a'));
  StoreSettings look;
  look.only_look = true;
  EXPECT_CODE(Store::Open(place_, look), kStoreDamaged);
  Reopen();
  EXPECT_THAT(Open().Rebuilt(), HasSubstr("set aside as"));
  EXPECT_THAT(Open().Rebuilt(), HasSubstr("20 attempts that came after it"));
  EXPECT_EQ(Count("attempt"), 60);
  EXPECT_EQ(Count("training_group"), 1);
  EXPECT_GOOD(Verify(Open()));
  int aside = 0;
  for (const auto& entry : fs::directory_iterator(folder_.Path()))
    aside += entry.path().filename().string().find(".damaged-") != std::string::npos ? 1 : 0;
  EXPECT_GE(aside, 1);
  Reopen();
  EXPECT_THAT(Open().Rebuilt(), IsEmpty()) << "once is enough";
}

TEST_P(SqliteFaults, DamagedWithoutBackupKeepsTheAttempts) {
  Deliver(0, 30);
  CloseStore();
  Overwrite(0, "no database any more");
  Reopen();
  EXPECT_THAT(Open().Rebuilt(), HasSubstr("there was no backup"));
  EXPECT_EQ(Count("attempt"), 30);
  EXPECT_EQ(Get(FindPerson(Open(), trainee_)).pseudonym, trainee_);
}

TEST_P(SqliteFaults, DamagedBackupIsPassedOver) {
  Deliver(0, 10);
  EXPECT_GOOD(BackUp(Open(), kOwner));
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const fs::path newest = Get(BackUp(Open(), kOwner));
  std::string bytes = ReadAll(newest);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  std::ofstream(newest, std::ios::binary) << bytes;
  EXPECT_CODE(VerifyBackup(newest), kStoreDamaged);
  CloseStore();
  Overwrite(0, std::string(100, 'x'));
  Reopen();
  EXPECT_THAT(Open().Rebuilt(), HasSubstr("built again from the backup"));
  EXPECT_THAT(Open().Rebuilt(), testing::Not(HasSubstr(newest.filename().string())));
  EXPECT_EQ(Count("attempt"), 10);
}

// Every page of a small store is damaged in turn: found at opening or by verify, or the page was free.
TEST_P(SqliteFaults, DamageIsFoundOnEveryPage) {
  Deliver(0, 5);
  CloseStore();
  const std::string good = ReadAll(place_.url);
  int found = 0, pages = static_cast<int>(good.size() / 4096);
  for (int page = 0; page < pages; ++page) {
    std::string bad = good;
    for (std::size_t i = 0; i < 64; ++i) bad[static_cast<std::size_t>(page) * 4096 + i] = '\x77';
    std::ofstream(place_.url, std::ios::binary) << bad;
    StoreSettings look;
    look.only_look = true;
    found += Store::Open(place_, look).ok() ? 0 : 1;
    for (const char* part : {"-wal", "-shm"}) fs::remove(place_.url + part);
  }
  EXPECT_EQ(found, pages);
}

TEST_P(SqliteFaults, AFileThatIsNoStoreStaysWhatItIs) {
  const std::string text = "my thesis, chapter 1\n" + std::string(5000, 'x');
  Place thesis{folder_.Path() / "thesis.txt", folder_.Path() / "thesis.files"};
  std::ofstream(thesis.url, std::ios::binary) << text;
  EXPECT_CODE(Store::Open(thesis), kStoreSchema);
  // also when attempts already wait for it
  EXPECT_FALSE(Get(KeepAttempt(thesis, MakeAttempt(1, trainee_))).is_in_store);
  EXPECT_CODE(Store::Open(thesis), kStoreSchema);
  EXPECT_EQ(ReadAll(thesis.url), text);
  Place other{folder_.Path() / "other.sqlite", folder_.Path() / "other.files"};
  EXPECT_GOOD(Get(OpenSqlite(other.url, 2))->RunScript("CREATE TABLE recipes (name TEXT)"));
  EXPECT_CODE(Store::Open(other), kStoreSchema);
}

TEST_P(SqliteFaults, ALaterSchemaIsRefused) {
  EXPECT_TRUE(Open().GetDatabase().Run("UPDATE setting SET value = '99' WHERE name = 'schema'").ok());
  store_.reset();
  EXPECT_CODE(Store::Open(place_), kStoreSchema);
  const KeepReport report = Get(KeepAttempt(place_, MakeAttempt(1, trainee_)));
  EXPECT_FALSE(report.is_in_store);
  EXPECT_EQ(spool().CountWaiting(), 1u);
}

class PostgresFaults : public SqliteFaults {
 protected:
  PostgresServer& server() { return PostgresServer::Get(); }
  std::int64_t BackendOf(Store& store) {
    const auto pid = store.GetDatabase().Run("SELECT pg_backend_pid()");
    return pid.ok() ? pid->rows[0].Int(0) : -1;
  }
  static StoreSettings Quick() {
    StoreSettings settings;
    settings.answer_seconds = 2;
    return settings;
  }
  /// Whatever happened: the attempt waits, and arrives once when all is well again.
  void ExpectArrivesOnce(int number) {
    Reopen();
    EXPECT_FALSE(spool().Deliver(Open()).failure);
    EXPECT_EQ(spool().CountWaiting(), 0u);
    EXPECT_EQ(Count("attempt WHERE recording_id = '" + MakeAttempt(number, "").recording_id + "'"), 1);
    EXPECT_GOOD(Verify(Open()));
  }
};
INSTANTIATE_TEST_SUITE_P(Databases, PostgresFaults, testing::Values(Kind::kPostgres), KindName);

TEST_P(PostgresFaults, ConnectionTerminatedWithinATransaction) {
  Database& database = Open().GetDatabase();
  const std::int64_t backend = BackendOf(Open());
  EXPECT_GOOD(spool().Keep(MakeAttempt(1, trainee_)));
  EXPECT_GOOD(database.Begin(Access::kWrite));
  EXPECT_TRUE(database.Run("UPDATE person SET added_ms = 0").ok());
  EXPECT_GOOD(server().Administer("SELECT pg_terminate_backend(" + std::to_string(backend) + ")"));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const DeliveryReport report = spool().Deliver(Open());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreAway) << report.failure->Text();
  ExpectArrivesOnce(1);
  EXPECT_EQ(Count("person WHERE added_ms = 0"), 0) << "half a transaction stays nothing";
}

TEST_P(PostgresFaults, ServerKilledAndStartedAgain) {
  Deliver(0, 3);
  EXPECT_GOOD(spool().Keep(MakeAttempt(3, trainee_)));
  server().Stop(SIGQUIT);  // as a crash
  DeliveryReport report = spool().Deliver(Open());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreAway) << report.failure->Text();
  EXPECT_CODE(OpenResult(), kStoreAway);
  server().Start();
  ExpectArrivesOnce(3);
  EXPECT_EQ(Count("attempt"), 4);
}

TEST_P(PostgresFaults, SilentServerCountsAsAway) {
  store_.reset();
  auto opened = OpenResult(Quick());
  ASSERT_TRUE(opened.ok());
  store_.emplace(std::move(*opened));
  const auto backend = static_cast<pid_t>(BackendOf(Open()));
  EXPECT_GOOD(spool().Keep(MakeAttempt(1, trainee_)));
  ASSERT_EQ(::kill(backend, SIGSTOP), 0);
  const host::Stopwatch watch;
  const DeliveryReport report = spool().Deliver(Open());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreAway);
  EXPECT_THAT(report.failure->message, HasSubstr("not answered"));
  EXPECT_LT(watch.Seconds(), 8);
  ::kill(backend, SIGCONT);
  // one that does not even take the connection
  server().Server().Signal(SIGSTOP);
  EXPECT_CODE(OpenResult(Quick()), kStoreAway);
  EXPECT_LT(watch.Seconds(), 30);
  server().Server().Signal(SIGCONT);
  ExpectArrivesOnce(1);
}

TEST_P(PostgresFaults, ReadOnlyServer) {
  EXPECT_GOOD(server().Administer("ALTER DATABASE " + database_ + " SET default_transaction_read_only = on"));
  Reopen();  // can still be looked at
  EXPECT_GOOD(ListAttempts(Open(), kOwner, {}));
  EXPECT_GOOD(spool().Keep(MakeAttempt(1, trainee_)));
  const DeliveryReport report = spool().Deliver(Open());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreReadOnly) << report.failure->Text();
  EXPECT_GOOD(
      server().Administer("ALTER DATABASE " + database_ + " SET default_transaction_read_only = off"));
  ExpectArrivesOnce(1);
}

TEST_P(PostgresFaults, LockedByAnotherProgram) {
  auto other = Get(OpenPostgres(place_.url, 2, 10));
  EXPECT_GOOD(other->Begin(Access::kWrite));
  EXPECT_GOOD(other->RunScript("LOCK TABLE attempt IN ACCESS EXCLUSIVE MODE"));
  EXPECT_GOOD(spool().Keep(MakeAttempt(1, trainee_)));
  const DeliveryReport report = spool().Deliver(Open());
  ASSERT_TRUE(report.failure.has_value());
  EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreBusy) << report.failure->Text();
  other->Rollback();
  EXPECT_EQ(spool().Deliver(Open()).added, 1) << "the connection is still good";
}

// What a server answers whose disk is full: 53100 from any of the tables that an attempt goes into.
TEST_P(PostgresFaults, FullDiskOfTheServer) {
  EXPECT_GOOD(server().Administer(
      "CREATE FUNCTION no_room() RETURNS trigger LANGUAGE plpgsql AS "
      "$$BEGIN RAISE EXCEPTION 'could not extend file' USING ERRCODE = 'disk_full'; END$$",
      database_));
  int number = 0;
  for (const std::string table : {"attempt", "metric", "standing"}) {
    SCOPED_TRACE(table);
    EXPECT_GOOD(server().Administer("CREATE TRIGGER full_disk BEFORE INSERT ON " + table +
                                        " FOR EACH STATEMENT EXECUTE FUNCTION no_room()",
                                    database_));
    EXPECT_GOOD(spool().Keep(MakeAttempt(number, trainee_)));
    const DeliveryReport report = spool().Deliver(Open());
    ASSERT_TRUE(report.failure.has_value());
    EXPECT_EQ(report.failure->code, base::ErrorCode::kStoreFull) << report.failure->Text();
    EXPECT_THAT(report.failure->message, HasSubstr("free space there"));
    EXPECT_EQ(report.damaged, 0);
    EXPECT_EQ(spool().CountWaiting(), 1u);
    EXPECT_EQ(Count("attempt"), number) << "half an attempt was kept";
    EXPECT_EQ(Count("metric"), 5 * number);
    EXPECT_GOOD(server().Administer("DROP TRIGGER full_disk ON " + table, database_));
    EXPECT_EQ(spool().Deliver(Open()).added, 1) << "the connection is still good";
    ++number;
  }
  ExpectArrivesOnce(0);
}

TEST_P(PostgresFaults, AwayOrOfAnotherSchema) {
  const auto nowhere =
      Store::Open({"postgresql://someone:secret@/x?host=/nowhere", folder_.Path() / "n"}, Quick());
  ASSERT_FALSE(nowhere.ok());
  EXPECT_EQ(nowhere.error().code, base::ErrorCode::kStoreAway);
  EXPECT_THAT(nowhere.error().message, testing::Not(HasSubstr("secret")));
  EXPECT_EQ((Place{"postgresql://u:secret@h/d?password=more&sslmode=require&x=1", {}}).Text(),
            "postgresql://u@h/d?sslmode=require");
  EXPECT_EQ((Place{"postgresql://u:se/cret@h/d?password=a&password=b", {}}).Text(), "postgresql://u@h/d");
  EXPECT_TRUE(Open().GetDatabase().Run("UPDATE setting SET value = '99' WHERE name = 'schema'").ok());
  EXPECT_CODE(OpenResult(), kStoreSchema);
  Place other = MakePlace("other");
  EXPECT_GOOD(Get(OpenPostgres(other.url, 2, 10))->RunScript("CREATE TABLE recipes (name TEXT)"));
  EXPECT_CODE(Store::Open(other), kStoreSchema);
}

}  // namespace
}  // namespace trocar::store
