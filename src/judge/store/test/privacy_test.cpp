// SPDX-License-Identifier: Apache-2.0
// Export and erasure of one person. What is left is looked for in the raw bytes of every file.
#include <nlohmann/json.hpp>

#include "private_file.h"
#include "store_test.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"
#include "trocar/store/names.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class Privacy : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    if (!store_) return;
    // long enough to be nowhere by chance
    for (auto* name : {&gone_, &other_}) *name = Add(Role::kTrainee);
    EXPECT_GOOD(SetName(place_.NamesFile(), gone_, "Zacharias Quux"));
    EXPECT_GOOD(SetName(place_.NamesFile(), other_, "Ada Lovelace"));
    EXPECT_GOOD(AddGroup(Open(), kOwner, "evening"));
    for (const auto& person : {gone_, other_}) EXPECT_GOOD(JoinGroup(Open(), kOwner, "evening", person));
    const Spool spool(place_);
    for (int i = 0; i < 40; ++i) {
      Attempt attempt = MakeAttempt(i, i % 2 == 0 ? gone_ : other_);
      attempt.recording = MakeRecording(attempt);
      attempt.outcome = i % 2 == 0 ? R"({"mark":"OUTCOME-OF-QUUX"})" : "{}";
      EXPECT_GOOD(spool.Keep(attempt));
    }
    EXPECT_EQ(spool.Deliver(Open()).added, 40);
    const std::int64_t id = Get(ListAttempts(Open(), kOwner, {gone_, "", ""})).attempts.at(0).id;
    EXPECT_GOOD(AddRemark(Open(), kOwner, id, 1, "REMARK-ON-QUUX"));
    const std::int64_t others = Get(ListAttempts(Open(), kOwner, {other_, "", ""})).attempts.at(0).id;
    EXPECT_GOOD(AddRemark(Open(), kOwner, others, 1, "better than " + gone_));
    EXPECT_GOOD(AddRemark(Open(), kOwner, others, 1, "REMARK-ON-ADA"));
    EXPECT_GOOD(AddCertificate(Open(), kOwner, {"c", gone_, "certificate of " + gone_}));
    EXPECT_GOOD(spool.Keep(MakeAttempt(900, gone_)));  // still waits
  }
  std::string MakeRecording(const Attempt& attempt) {
    const fs::path path = folder_.Path() / "recordings" / (attempt.recording_id + "-of.trocar");
    fs::create_directories(path.parent_path());
    std::string bytes(24, '\0');
    bytes.replace(0, 8, "TROCREC\n");
    const std::uint64_t id = std::stoull(attempt.recording_id, nullptr, 16);
    std::memcpy(bytes.data() + 16, &id, sizeof id);
    std::ofstream(path, std::ios::binary) << bytes << attempt.trainee << " played";
    std::ofstream(path.string() + ".index") << attempt.trainee;
    return path;
  }
  /// The folders that hold everything of this store; of a server, its tables, as they are on its disk.
  std::vector<std::string> Find(const std::string& text) {
    std::vector<std::string> found = FilesWith(folder_.Path(), text);
    if (GetParam() == Kind::kPostgres) {
      EXPECT_GOOD(PostgresServer::Get().Administer("CHECKPOINT"));
      const auto oid = Open().GetDatabase().Run(
          "SELECT CAST(oid AS BIGINT) FROM pg_database WHERE datname = current_database()");
      const auto base = fs::path(PostgresServer::Get().Data()) / "base" / std::to_string(oid->rows[0].Int(0));
      for (std::string& file : FilesWith(base, text)) found.push_back(std::move(file));
    }
    return found;
  }

  std::string gone_, other_;
};
INSTANTIATE_OVER_DATABASES(Privacy);

TEST_P(Privacy, ErasureLeavesNotOneByte) {
  if (GetParam() == Kind::kSqlite) EXPECT_GOOD(BackUp(Open(), kOwner));
  EXPECT_EQ(Spool(place_).Deliver(Open()).added, 1);  // into the journal, since the backup has it not
  EXPECT_GOOD(Spool(place_).Keep(MakeAttempt(901, gone_)));
  // a damaged store that was set aside holds everybody, too
  if (GetParam() == Kind::kSqlite) std::ofstream(place_.url + ".damaged-1") << gone_;
  const std::vector<std::string> marks = {gone_, "Quux", "OUTCOME-OF-QUUX", "REMARK-ON-QUUX"};
  for (const std::string& mark : marks)
    EXPECT_THAT(Find(mark), Not(IsEmpty())) << "the search finds nothing: " << mark;
  testing::internal::CaptureStderr();
  const EraseReport report = Get(ErasePerson(Open(), kOwner, gone_));
  EXPECT_EQ(report.attempts, 21);
  EXPECT_EQ(report.recordings, 20);
  EXPECT_EQ(report.spooled, GetParam() == Kind::kSqlite ? 2 : 1);  // with the journal
  EXPECT_THAT(report.left, IsEmpty());
  EXPECT_THAT(report.backups, IsEmpty());
  // while it is still open, and after it was closed
  for (const std::string& mark : marks) EXPECT_THAT(Find(mark), IsEmpty()) << mark;
  EXPECT_CODE(FindPerson(Open(), gone_), kStoreUnknown);
  EXPECT_CODE(ErasePerson(Open(), kOwner, gone_), kStoreUnknown);
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_EQ(log.find(gone_), std::string::npos);
  EXPECT_EQ(log.find("Quux"), std::string::npos);
  Reopen();
  for (const std::string& mark : marks) EXPECT_THAT(Find(mark), IsEmpty()) << mark;
  // the other's is all there
  EXPECT_EQ(Count("attempt"), 20);
  EXPECT_EQ(Count("remark"), 1);
  for (const char* mark : {"REMARK-ON-ADA", "Lovelace"}) EXPECT_THAT(Find(mark), Not(IsEmpty()));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.Path() / "recordings"), {}), 40);
  EXPECT_GOOD(Verify(Open()));
}

// A program that was killed while it wrote leaves a part of a file.
TEST_P(Privacy, ErasureTakesWhatKilledProgramsLeft) {
  const std::string nobody = ".part99999999";  // no such process
  const fs::path spool = place_.SpoolFolder();
  fs::create_directories(spool / "unmeasured");
  fs::create_directories(place_.BackupFolder());
  const std::vector<fs::path> remnants = {place_.folder / ".partial-AbCdEf",
                                          spool / ".partial-AbCdEf",
                                          spool / "unmeasured" / ("2026_peg.json" + nobody),
                                          place_.BackupFolder() / ("store-1.sqlite" + nobody),
                                          place_.BackupFolder() / ("store-1.sqlite" + nobody + "-journal"),
                                          place_.BackupFolder() / "store-2.sqlite.partial",
                                          place_.NamesFile().string() + ".old"};
  const auto leave = [&] {
    for (const fs::path& path : remnants) std::ofstream(path) << gone_ << " Zacharias Quux";
  };
  leave();
  // what a program still writes stays
  auto writer = PrivateFileWriter::Start(spool / "other.json");
  ASSERT_TRUE(writer.ok());
  EXPECT_EQ(Get(ErasePerson(Open(), kOwner, gone_)).attempts, 20);
  EXPECT_THAT(Find("Quux"), IsEmpty());
  EXPECT_THAT(Find(gone_), IsEmpty());
  EXPECT_GOOD(writer->Append("x"));
  EXPECT_GOOD(writer->Finish());
  EXPECT_EQ(ReadAll(spool / "other.json"), "x");
  fs::remove(spool / "other.json");
  // and each opening sweeps
  leave();
  Reopen();
  for (const fs::path& path : remnants) EXPECT_FALSE(fs::exists(path)) << path;
  // the old names are another name of the present ones where the program was killed in between: these stay
  fs::create_hard_link(place_.NamesFile(), place_.NamesFile().string() + ".old");
  Reopen();
  EXPECT_EQ(Get(ReadNames(place_.NamesFile())).at(other_), "Ada Lovelace");
}

TEST_P(Privacy, ErasureOfOneLeavesWhatIsOfANamesake) {
  for (const char* person : {"T-1", "T-10", "t-1"}) {
    Add(Role::kTrainee, person);
    EXPECT_GOOD(AddCertificate(Open(), kOwner, {person, person, std::string("of ") + person + ", passed"}));
  }
  const std::int64_t id = Get(ListAttempts(Open(), kOwner, {other_, "", ""})).attempts.at(0).id;
  for (const char* remark : {"as good as T-10", "XT-1", "like t-1", "like T-1's", "T-1"})
    EXPECT_GOOD(AddRemark(Open(), kOwner, id, 2, remark));
  EXPECT_GOOD(ErasePerson(Open(), kOwner, "T-1"));
  EXPECT_THAT(Get(ListCertificates(Open(), kOwner, "T-10")), SizeIs(1));
  EXPECT_THAT(Get(ListCertificates(Open(), kOwner, "t-1")), SizeIs(1));
  EXPECT_EQ(Count("certificate WHERE certificate_key = 'T-1'"), 0);
  std::vector<std::string> left;
  for (const Remark& remark : Get(ListRemarks(Open(), kOwner, id)))
    if (remark.tick == 2) left.push_back(remark.text);
  EXPECT_THAT(left, testing::UnorderedElementsAre("as good as T-10", "XT-1", "like t-1"));
}

// Control: rows that were deleted without Purge are still found, so that the search above means something.
TEST_P(Privacy, DeletedRowsAloneLeaveBytes) {
  if (GetParam() == Kind::kSqlite) {
    EXPECT_TRUE(Open().GetDatabase().Run("PRAGMA secure_delete=OFF").ok());
  }
  EXPECT_TRUE(Open().GetDatabase().Run("DELETE FROM remark").ok());
  EXPECT_THAT(Find("REMARK-ON-QUUX"), Not(IsEmpty()));
}

// SQLite would put what a long statement may have to take back into an unnamed file in /var/tmp. Control: told to, it does.
TEST_P(Privacy, NothingLiesOutsideOfTheFolderWhileMuchIsWritten) {
  if (GetParam() == Kind::kPostgres) return;  // its server's folder
  Database& database = Open().GetDatabase();
  const auto count_open = [&] {
    int count = 0;
    for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
      std::error_code gone;
      const std::string file = fs::read_symlink(entry.path(), gone).string();
      count += file.ends_with("(deleted)") && !file.starts_with(folder_.Path().string());
    }
    return count;
  };
  // whoever started the test may have left it some
  const int inherited = count_open();
  const auto count_unnamed = [&] {
    EXPECT_GOOD(database.Begin(Access::kWrite));
    for (const char* sql :
         {"INSERT INTO remark (attempt_id, tick, content, written_ms) SELECT a.id, 1, hex(zeroblob(2000)), 0 "
          "FROM attempt a, attempt b",
          "UPDATE remark SET content = content || content"}) {
      EXPECT_TRUE(database.Run(sql).ok());
    }
    const int count = count_open() - inherited;
    database.Rollback();
    return count;
  };
  EXPECT_EQ(count_unnamed(), 0);
  EXPECT_TRUE(database.Run("PRAGMA temp_store=FILE").ok());
  EXPECT_GT(count_unnamed(), 0);
}

TEST_P(Privacy, ErasureNamesWhatItCannotReach) {
  const fs::path elsewhere = folder_.Path() / "usb" / "b.sqlite";
  EXPECT_GOOD(BackUp(Open(), kOwner, elsewhere));
  fs::remove(fs::directory_iterator(folder_.Path() / "recordings")->path());
  const auto listed = Get(ListAttempts(Open(), kOwner, {gone_, "", ""}));
  const std::string exchanged = listed.attempts.at(3).attempt.recording;
  std::ofstream(exchanged, std::ios::binary) << "somebody's holiday picture, not a recording";
  const EraseReport report = Get(ErasePerson(Open(), kOwner, gone_));
  EXPECT_THAT(report.backups, testing::ElementsAre(elsewhere.string()));
  EXPECT_THAT(report.left, testing::Contains(testing::HasSubstr(exchanged)));
  EXPECT_TRUE(fs::exists(exchanged));
}

// A server skips what is not the account's own, without an error: that must not pass for erasure.
TEST_P(Privacy, ErasureByAnAccountWithoutTheTablesIsNoErasure) {
  if (GetParam() == Kind::kSqlite) return;  // has no accounts
  PostgresServer& server = PostgresServer::Get();
  EXPECT_GOOD(server.Administer("CREATE ROLE guest LOGIN"));
  EXPECT_GOOD(server.Administer("GRANT ALL ON ALL TABLES IN SCHEMA public TO guest", database_));
  Place guest = place_;
  guest.url.replace(guest.url.find("postgres@"), 9, "guest@");
  auto store = Store::Open(guest);
  ASSERT_TRUE(store.ok()) << store.error().Text();
  EXPECT_CODE(ErasePerson(*store, kOwner, gone_), kStoreReadOnly);
  EXPECT_THAT(Find("REMARK-ON-QUUX"), Not(IsEmpty()));
  // the owner finishes it
  EXPECT_GOOD(Tidy(Open(), kOwner, 0));
  EXPECT_THAT(Find("REMARK-ON-QUUX"), IsEmpty());
}

TEST_P(Privacy, ExportIsAllThatIsKnown) {
  const fs::path folder = folder_.Path() / "for them";
  EXPECT_EQ(Get(ExportPerson(Open(), kOwner, gone_, folder)), 20);
  const auto json = nlohmann::json::parse(ReadAll(folder / "person.json"));
  EXPECT_EQ(json["pseudonym"], gone_);
  EXPECT_EQ(json["name"], "Zacharias Quux");
  EXPECT_EQ(json["groups"][0], "evening");
  ASSERT_THAT(json["attempts"], SizeIs(20));
  EXPECT_THAT(json["attempts"][0]["metrics"], SizeIs(5));
  EXPECT_EQ(json["attempts"][0]["remarks"][0]["text"], "REMARK-ON-QUUX");
  EXPECT_EQ(json["attempts"][0]["outcome"]["mark"], "OUTCOME-OF-QUUX");
  EXPECT_THAT(json["certificates"], SizeIs(1));
  EXPECT_TRUE(fs::exists(folder / json["attempts"][0]["recording"].get<std::string>()));
  EXPECT_THAT(FilesWith(folder, other_), IsEmpty()) << "another's pseudonym";
  EXPECT_CODE(ExportPerson(Open(), kOwner, gone_, folder), kFileUnwritable);
  EXPECT_CODE(ExportPerson(Open(), kOwner, "T-NOBODY", folder_.Path() / "x"), kStoreUnknown);
}

TEST_P(Privacy, AClockThatIsWrongRemovesNothing) {
  EXPECT_GOOD(SetRetention(Open(), kOwner, 400));
  const std::int64_t before = Count("attempt");
  ASSERT_GT(before, 0);
  const std::int64_t now = Get(ParseTime("2026-12-31T12:00:00+01:00"));
  const std::int64_t late = Get(ParseTime("2040-01-31T12:00:00+01:00"));
  EXPECT_FALSE(Get(Tidy(Open(), kOwner, now)).unsure) << "the control";
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(Get(Tidy(Open(), kOwner, late + i * 30 * 86'400'000LL)).unsure);
  EXPECT_EQ(Count("attempt"), before);
  // who says yes without a look has a week to notice
  EXPECT_EQ(Get(Tidy(Open(), kOwner, late, true)).attempts, 0);
  EXPECT_EQ(Count("attempt WHERE due_ms IS NOT NULL"), before);
  EXPECT_EQ(Get(Tidy(Open(), kOwner, now, true)).due, 0) << "the clock is right again";
  EXPECT_EQ(Count("attempt WHERE due_ms IS NOT NULL"), 0);
  EXPECT_EQ(Count("attempt"), before);
  // erasing a person waits for nothing
  EXPECT_EQ(Get(ErasePerson(Open(), kOwner, gone_)).attempts, 20);
}

TEST_P(Privacy, NamesAreNowhereButInTheirFile) {
  const auto found = Find("Quux");
  for (const std::string& file : found) {
    EXPECT_TRUE(file == place_.NamesFile() || ReadAll(file).find("OUTCOME-OF-QUUX") != std::string::npos)
        << file;
  }
  EXPECT_THAT(Find("Lovelace"), testing::ElementsAre(place_.NamesFile().string()));
}

TEST_P(Privacy, OldAttemptsGoWithTheirTime) {
  for (int day = 0; day < 10; ++day) {
    Attempt attempt = MakeAttempt(1000 + 1000 * day, other_);
    attempt.recording_id = base::HashText(0x777000 + static_cast<std::uint64_t>(day));
    attempt.outcome = day < 4 ? R"({"mark":"LONG-AGO"})" : "{}";
    attempt.recording = MakeRecording(attempt);
    EXPECT_TRUE(Get(AddAttempt(Open(), attempt)));
  }
  const std::int64_t now = Get(ParseTime("2026-01-31T12:00:00+01:00"));
  EXPECT_EQ(Get(ReadRetention(Open())), 0);
  EXPECT_EQ(Get(Tidy(Open(), kOwner, now)).attempts, 0) << "without a limit everything stays";
  EXPECT_CODE(SetRetention(Open(), kOwner, -1), kStoreInvalid);
  EXPECT_GOOD(SetRetention(Open(), kOwner, 26));
  const std::string gone =
      Get(ListAttempts(Open(), kOwner, {gone_, "", ""})).attempts.at(0).attempt.recording;
  fs::remove(gone);
  const TidyReport asked = Get(Tidy(Open(), kOwner, now));
  ASSERT_TRUE(asked.unsure.has_value()) << "more than half of them";
  EXPECT_EQ(asked.unsure->code, base::ErrorCode::kUsage);
  EXPECT_EQ(asked.attempts + asked.due, 0);
  EXPECT_GOOD(VerifyBackup(asked.backup));
  constexpr std::int64_t kDay = 86'400'000;
  const TidyReport found = Get(Tidy(Open(), kOwner, now, true));
  EXPECT_EQ(found.attempts, 0) << "none goes on the day on which it is found too old";
  EXPECT_EQ(found.due, 44);
  EXPECT_EQ(Count("attempt"), 50);
  // longer: they may stay
  EXPECT_GOOD(SetRetention(Open(), kOwner, 400));
  EXPECT_EQ(Get(Tidy(Open(), kOwner, now)).due, 0);
  EXPECT_GOOD(SetRetention(Open(), kOwner, 26));
  EXPECT_EQ(Get(Tidy(Open(), kOwner, now, true)).due, 44);
  EXPECT_GOOD(SetRetention(Open(), kOwner, 26 + kGraceDays));  // of the same days, a week on
  EXPECT_EQ(Get(Tidy(Open(), kOwner, now + kGraceDays * kDay - 1)).attempts, 0);
  const TidyReport report = Get(Tidy(Open(), kOwner, now + kGraceDays * kDay));
  EXPECT_FALSE(report.unsure) << "they were asked about";
  EXPECT_EQ(report.attempts, 44);
  EXPECT_EQ(report.recordings, 43);
  EXPECT_THAT(report.left, testing::ElementsAre(testing::HasSubstr(gone)))
      << "nobody else knows of it any more";
  EXPECT_GOOD(VerifyBackup(report.backup));
  EXPECT_EQ(Count("attempt"), 6);
  EXPECT_THAT(Find("LONG-AGO"), IsEmpty());
  EXPECT_GOOD(Verify(Open()));
}

}  // namespace
}  // namespace trocar::store
