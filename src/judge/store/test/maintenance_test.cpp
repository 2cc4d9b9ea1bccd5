// SPDX-License-Identifier: Apache-2.0
// Backups, export and import.
#include "trocar/store/maintenance.h"

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "store_test.h"
#include "trocar/host/clock.h"
#include "trocar/store/courses.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

class Maintenance : public StoreTest {
 protected:
  /// Something in every table.
  void Fill() {
    trainee_ = Add(Role::kTrainee), teacher_ = Add(Role::kInstructor);
    EXPECT_GOOD(AddGroup(Open(), kOwner, "'evening'"));
    for (const auto& person : {trainee_, teacher_})
      EXPECT_GOOD(JoinGroup(Open(), kOwner, "'evening'", person));
    EXPECT_GOOD(AddCourse(Open(), kOwner, {"basic", 1, "{}", {{"a", "peg_transfer", "easy"}}}));
    EXPECT_GOOD(AddAssignment(Open(), kOwner, {"basic", 1, "", "'evening'", 9000, {{"a", 5000}}}));
    EXPECT_GOOD(
        SetThreshold(Open(), kOwner, {{"peg_transfer", "easy", "score", "", "", ""}, 50, true, "ours"}));
    for (int i = 0; i < 20; ++i)
      EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(i, i % 4 == 0 ? "" : trainee_))));
    const std::int64_t id = Get(ListAttempts(Open(), kOwner, {trainee_, "", ""})).attempts.at(0).id;
    EXPECT_GOOD(AddRemark(Open(), kOwner, id, 3, std::string("nul\0 \"quoted\"", 13)));
    EXPECT_GOOD(AddRating(Open(), Get(FindViewer(Open(), teacher_)), id, {"GOALS", "efficiency", 4, ""}));
    EXPECT_GOOD(AddCertificate(Open(), kOwner, {"c", trainee_, "signed"}));
  }
  /// What is in a store, without its ids.
  nlohmann::json Content(Store& store) {
    const fs::path file = folder_.Path() / "content.json";
    EXPECT_GOOD(ExportJson(store, kOwner, file));
    auto json = nlohmann::json::parse(ReadAll(file))["tables"];
    for (auto& table : json) {
      for (auto& row : table) {
        for (auto field = row.begin(); field != row.end();) {
          const bool is_id =
              (field.key() == "id" || field.key().ends_with("_id")) && field.key() != "recording_id";
          field = is_id ? row.erase(field) : std::next(field);
        }
      }
      std::sort(table.begin(), table.end());
    }
    return json;
  }
  std::string trainee_, teacher_;
};
INSTANTIATE_OVER_DATABASES(Maintenance);

TEST_P(Maintenance, BackupHoldsEverything) {
  Fill();
  const fs::path backup = Get(BackUp(Open(), kOwner, folder_.Path() / "centre.sqlite"));
  EXPECT_GOOD(VerifyBackup(backup));
  EXPECT_EQ(test::RunProcess({"/bin/sh", "-c",
                              "cd " + folder_.Path().string() + " && sha256sum -c " +
                                  backup.filename().string() + ".sha256"})
                .status,
            0);
  auto copy = Store::Open({backup.string(), folder_.Path() / "copy.files"});
  ASSERT_TRUE(copy.ok()) << copy.error().Text();
  EXPECT_EQ(Content(*copy), Content(Open()));
  EXPECT_GOOD(Verify(*copy));
  std::string bytes = ReadAll(backup);
  bytes[bytes.size() / 3] = static_cast<char>(bytes[bytes.size() / 3] ^ 4);
  std::ofstream(backup, std::ios::binary) << bytes;
  EXPECT_CODE(VerifyBackup(backup), kStoreDamaged);
  fs::remove(backup.string() + ".sha256");
  EXPECT_CODE(VerifyBackup(backup), kFileMissing);
}

// Each backup is of one moment: whole attempts, with all their metrics, and standings that fit.
TEST_P(Maintenance, BackupIsConsistentWhileOthersWrite) {
  Fill();
  std::atomic<bool> is_done = false;
  std::atomic<int> added = 0;
  std::thread writer([&] {
    auto other = Store::Open(place_);
    ASSERT_TRUE(other.ok());
    for (int i = 100; !is_done; ++i) {
      if (AddAttempt(*other, MakeAttempt(i, trainee_)).ok()) ++added;
    }
  });
  const auto wait_for_more = [&](int than) {
    const host::Stopwatch watch;
    while (added <= than && watch.Seconds() < 60) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_GT(added, than) << "nothing is written meanwhile: the test shows nothing";
  };
  for (int b = 0; b < 5; ++b) {
    wait_for_more(added);
    const fs::path backup =
        Get(BackUp(Open(), kOwner, folder_.Path() / ("b" + std::to_string(b) + ".sqlite")));
    auto copy = Store::Open({backup.string(), folder_.Path() / ("b" + std::to_string(b) + ".files")});
    if (!copy.ok()) {
      ADD_FAILURE() << copy.error().Text();
      continue;
    }
    EXPECT_GOOD(Verify(*copy));
    const auto parts = copy->GetDatabase().Run(
        "SELECT COUNT(*) FROM attempt WHERE (SELECT COUNT(*) FROM metric WHERE attempt_id = attempt.id) <> "
        "5");
    ASSERT_TRUE(parts.ok());
    EXPECT_EQ(parts->rows[0].Int(0), 0);
  }
  is_done = true;
  writer.join();
}

TEST_P(Maintenance, ExportGoesIntoTheOtherDatabase) {
  Fill();
  const fs::path file = folder_.Path() / "export.json", backup = folder_.Path() / "backup.sqlite";
  EXPECT_GOOD(ExportJson(Open(), kOwner, file));
  EXPECT_GOOD(BackUp(Open(), kOwner, backup));
  const Kind other_kind = GetParam() == Kind::kSqlite ? Kind::kPostgres : Kind::kSqlite;
  for (const fs::path& from : {file, backup}) {
    auto other = Store::Open(MakePlace(other_kind, "other_" + from.stem().string()));
    ASSERT_TRUE(other.ok()) << other.error().Text();
    // ids that are taken by others must not matter
    EXPECT_GOOD(AddPerson(*other, kOwner, Role::kTrainee));
    EXPECT_GOOD(AddGroup(*other, kOwner, "another"));
    EXPECT_TRUE(Get(AddAttempt(*other, MakeAttempt(777, ""))));
    const ImportReport report = Get(Import(*other, kOwner, from, Trust::kAsItSays));
    EXPECT_EQ(report.people, 2);
    EXPECT_EQ(report.groups, 1);
    EXPECT_EQ(report.courses, 1);
    EXPECT_EQ(report.attempts, 20);
    EXPECT_EQ(report.known, 0);
    EXPECT_GOOD(Verify(*other));
    const ImportReport again = Get(Import(*other, kOwner, from, Trust::kAsItSays));
    EXPECT_EQ(again.people + again.groups + again.courses + again.attempts, 0);
    EXPECT_EQ(again.known, 20);
    for (const char* sql :
         {"DELETE FROM attempt WHERE task = 'peg_transfer' AND recording_id = '0000000000001309'",
          "DELETE FROM training_group WHERE name = 'another'"})
      EXPECT_TRUE(other->GetDatabase().Run(sql).ok());
    nlohmann::json content = Content(*other), expected = Content(Open());
    content.erase("person"), expected.erase("person");
    EXPECT_EQ(content, expected);
  }
}

TEST_P(Maintenance, BadExportsChangeNothing) {
  Fill();
  const fs::path file = folder_.Path() / "export.json", bad = folder_.Path() / "bad.json";
  EXPECT_GOOD(ExportJson(Open(), kOwner, file));
  const std::string good = ReadAll(file);
  auto other = Store::Open(MakePlace("empty"));
  ASSERT_TRUE(other.ok());
  const auto import = [&](const std::string& text) {
    std::ofstream(bad, std::ios::binary) << text;
    return Import(*other, kOwner, bad);
  };
  for (std::size_t length = 0; length + 2 < good.size(); length += 1 + good.size() / 60)
    EXPECT_FALSE(import(good.substr(0, length)).ok()) << length;
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  EXPECT_CODE(import(replaced("\"version\": 1", "\"version\": 2")), kStoreSchema);
  EXPECT_CODE(import(replaced("trocar-store", "other-store")), kStoreSchema);
  EXPECT_CODE(import(replaced("\"pseudonym\":", "\"name\":")), kJsonField);
  EXPECT_CODE(import(replaced("\"role\":\"trainee\"", "\"role\":\"god\"")), kStoreInvalid);
  EXPECT_CODE(import(replaced("\"role\":\"trainee\"", "\"role\":7")), kJsonField);
  EXPECT_CODE(import(replaced("\"group_id\":1", "\"group_id\":99")), kJsonField);
  EXPECT_CODE(import(replaced("\"membership\"", "\"sqlite_schema\"")), kJsonField);
  EXPECT_CODE(import(replaced("\"verification\":\"verified\"", "\"verification\":\"sure\"")), kJsonField);
  EXPECT_CODE(import(replaced("\"verification_why\":\"\"", "\"verification_why\":\"x\"")), kJsonField);
  EXPECT_CODE(import(replaced("\"pseudonym\":\"", "\"pseudonym\":\"../../")), kJsonField);
  EXPECT_CODE(import(replaced("\"pseudonym\":\"", "\"pseudonym\":\"\\n")), kJsonField);
  EXPECT_CODE(import("[]"), kJsonField);
  EXPECT_CODE(import("{}"), kStoreSchema);
  EXPECT_CODE(import("\"x\""), kJsonField);
  EXPECT_CODE(Import(*other, kOwner, folder_.Path() / "none.json"), kFileMissing);
  const StoreCounts counts = Get(CountAll(*other, kOwner));
  EXPECT_EQ(counts.people + counts.groups + counts.courses + counts.attempts, 0);
  EXPECT_GOOD(import(good));
}

TEST_P(Maintenance, CsvHoldsEachNumber) {
  Fill();
  Add(Role::kTrainee, "a \"b\", c");
  EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(50, "a \"b\", c"))));
  EXPECT_GOOD(ExportCsv(Open(), kOwner, folder_.Path() / "a.csv"));
  const std::string csv = ReadAll(folder_.Path() / "a.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\r'), 1 + 21 * 5);
  Add(Role::kTrainee, "=SUM(A1)");
  EXPECT_TRUE(Get(AddAttempt(Open(), MakeAttempt(51, "=SUM(A1)"))));
  EXPECT_GOOD(ExportCsv(Open(), kOwner, folder_.Path() / "b.csv"));
  EXPECT_THAT(ReadAll(folder_.Path() / "b.csv"), HasSubstr(",'=SUM(A1),peg_transfer"));
  EXPECT_THAT(csv, HasSubstr(",\"a \"\"b\"\", c\",peg_transfer,easy,,7,1,1,path_length,left,,,"));
}

TEST_P(Maintenance, KeepsTheNewestBackups) {
  Fill();
  for (int i = 0; i < 7; ++i) {
    EXPECT_GOOD(BackUp(Open(), kOwner));
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  int files = 0;
  for (const auto& entry : fs::directory_iterator(place_.BackupFolder()))
    files += entry.path().extension() == ".sqlite" ? 1 : 0;
  EXPECT_EQ(files, 5);
}

}  // namespace
}  // namespace trocar::store
