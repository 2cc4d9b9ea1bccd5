// SPDX-License-Identifier: Apache-2.0
// Attempts wait until the store has them, and arrive once each.
#include "trocar/store/spool.h"

#include <signal.h>

#include <memory>
#include <random>
#include <set>

#include "store_test.h"
#include "trocar/record/recording.h"
#include "trocar/store/keep_attempt.h"
#include "trocar/store/maintenance.h"

namespace trocar::store {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::SizeIs;

class SpoolOver : public StoreTest {};
INSTANTIATE_OVER_DATABASES(SpoolOver);

TEST_P(SpoolOver, DeliversOnceAndHoldsStrangers) {
  const std::string trainee = Add(Role::kTrainee);
  const Spool spool(place_);
  for (int i = 0; i < 5; ++i) EXPECT_GOOD(spool.Keep(MakeAttempt(i, trainee)));
  EXPECT_GOOD(spool.Keep(MakeAttempt(0, trainee)));  // the same one again
  EXPECT_GOOD(spool.Keep(MakeAttempt(9, "T-STRANG")));
  EXPECT_EQ(spool.CountWaiting(), 6u);
  DeliveryReport report = spool.Deliver(Open());
  EXPECT_FALSE(report.failure);
  EXPECT_EQ(report.added, 5);
  EXPECT_EQ(report.held, 1);
  EXPECT_EQ(spool.CountWaiting(), 0u);
  EXPECT_EQ(Count("attempt"), 5);
  EXPECT_GOOD(spool.Keep(MakeAttempt(3, trainee)));
  report = spool.Deliver(Open());
  EXPECT_EQ(report.added, 0);
  EXPECT_EQ(report.known, 1);
  Add(Role::kTrainee, "T-STRANG");
  EXPECT_EQ(spool.DeliverHeld(Open()).added, 1);
  EXPECT_EQ(spool.CountHeld(), 0u);
  EXPECT_GOOD(Verify(Open()));
}

TEST_P(SpoolOver, PutsDamagedAttemptsAside) {
  const std::string trainee = Add(Role::kTrainee);
  const Spool spool(place_);
  EXPECT_GOOD(spool.Keep(MakeAttempt(1, trainee)));
  const auto first = fs::directory_iterator(place_.SpoolFolder())->path();
  std::string text = ReadAll(first);
  text[text.find("peg_transfer")] = 'P';
  std::ofstream(first, std::ios::binary) << text;
  std::ofstream(place_.SpoolFolder() / "empty.json");
  EXPECT_GOOD(spool.Keep(MakeAttempt(2, trainee)));
  const DeliveryReport report = spool.Deliver(Open());
  EXPECT_FALSE(report.failure);
  EXPECT_EQ(report.damaged, 2);
  EXPECT_EQ(report.added, 1) << "those behind it still arrive";
  EXPECT_TRUE(fs::exists(place_.SpoolFolder() / "damaged" / first.filename())) << "nothing is thrown away";
}

// Of a file that cannot be read any more the letters decide, as they are written in it.
TEST_P(SpoolOver, ErasesDamagedAttemptsOfAnyPseudonym) {
  const std::string odd = "a \"b\", \\c";
  const Spool spool(place_);
  EXPECT_GOOD(spool.Keep(MakeAttempt(1, odd)));
  EXPECT_GOOD(spool.Keep(MakeAttempt(2, "T-OTHER")));
  for (const auto& entry : fs::directory_iterator(place_.SpoolFolder())) {
    if (!entry.is_regular_file()) continue;
    std::string text = ReadAll(entry.path());
    text[text.find("peg_transfer")] = 'P';
    std::ofstream(entry.path(), std::ios::binary) << text;
  }
  EXPECT_EQ(spool.Deliver(Open()).damaged, 2);
  EXPECT_EQ(Get(spool.Erase(odd)), 1);
  EXPECT_EQ(Get(spool.Erase(odd)), 0);
  EXPECT_EQ(Get(spool.Erase("T-OTHER")), 1);
}

TEST(SpoolFile, IsFoundDamagedAtEveryByte) {
  const std::string seal(32, 'k');
  const std::string good = WriteAttemptJson(MakeAttempt(1, "T-1"), seal);
  ASSERT_EQ(WriteAttemptJson(Get(ReadAttemptJson(good, "good", seal)), seal), good);
  for (std::size_t length = 0; length + 1 < good.size(); ++length)
    EXPECT_FALSE(ReadAttemptJson(good.substr(0, length), "cut", seal).ok()) << length;
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    const auto read = ReadAttemptJson(bad, "flipped", seal);
    // white space between the fields may become other white space; without its seal it is not verified
    EXPECT_TRUE(!read.ok() || !read->mark.Counts() || WriteAttemptJson(*read, seal) == good) << at;
  }
}

TEST(BackOff, WaitsLongerEachTimeAndNeverTheSame) {
  BackOff one(1, 1, 60), other(2, 1, 60);
  double most = 0, first = one.Next();
  EXPECT_LE(first, 1);
  EXPECT_NE(first, other.Next());
  for (int i = 1; i < 40; ++i) {
    const double pause = one.Next();
    EXPECT_GT(pause, 0.09 * std::min(60.0, std::pow(2.0, i)));
    EXPECT_LE(pause, std::min(60.0, std::pow(2.0, i)));
    most = std::max(most, pause);
  }
  EXPECT_GT(most, 30);
  one.Reset();
  EXPECT_LE(one.Next(), 1);
}

TEST_P(SpoolOver, KeepsAnAttemptFromItsRecording) {
  const std::string trainee = Add(Role::kTrainee);
  record::Recording recording;
  recording.file_id = 0xabcdef;
  recording.description.name = "peg_transfer";
  recording.description.level = "easy";
  recording.description.seed = 3;
  recording.description.tick_seconds = 1.0 / 120;
  recording.description.started = "2026-11-24T22:50:20+01:00";
  recording.inputs.resize(240);
  Attempt killed = Get(DescribeAttempt(recording, "/x/a.trocar"));
  EXPECT_FALSE(killed.is_completed);
  recording.ending = record::Ending{240, 1, R"({"seconds":2,"task":{"phase":"completed","score":71.5}})"};
  Attempt attempt = Get(DescribeAttempt(recording, "/x/a.trocar"));
  EXPECT_EQ(attempt.recording_id, "0000000000abcdef");
  EXPECT_DOUBLE_EQ(attempt.seconds, 2);
  EXPECT_TRUE(attempt.is_completed);
  EXPECT_EQ(attempt.score, 71.5);
  attempt.trainee = trainee;
  const KeepReport report = Get(KeepAttempt(place_, attempt));
  EXPECT_TRUE(report.is_in_store) << report.failure->Text();
  EXPECT_EQ(Count("attempt"), 1);
  recording.ending->outcome = R"({"task":{"phase":7,"score":"x"},"operation":[1]})";
  EXPECT_GOOD(DescribeAttempt(recording, "/x/a.trocar"));
  recording.ending->outcome = "no JSON";
  EXPECT_CODE(DescribeAttempt(recording, "/x/a.trocar"), kRecordingInvalid);
}

TEST_P(SpoolOver, TheCourierDeliversOnceTheStoreIsBack) {
  const std::string trainee = Add(Role::kTrainee);
  store_.reset();
  const Place good = place_;
  Place away = place_;
  away.url = GetParam() == Kind::kSqlite ? (folder_.Path() / "none" / "a" / "\n" / "..").string()
                                         : "postgresql://nobody@/none?host=/nowhere";
  {
    Courier courier(away, {}, 0.02, 0.1);
    EXPECT_GOOD(courier.Keep(MakeAttempt(1, trainee)));
    for (int i = 0; i < 3000 && !courier.Failure(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_TRUE(courier.Failure().has_value());
  }
  Courier courier(good, {}, 0.02, 0.1);
  const Spool spool(good);
  for (int i = 0; i < 3000 && spool.CountWaiting() > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  Reopen();
  EXPECT_EQ(Count("attempt"), 1);
}

// Eight programs at once, whose attempts overlap: each key is there once, none is lost, and the standings count each.
TEST_P(SpoolOver, TakesEightProgramsAtOnce) {
  const std::string trainee = Add(Role::kTrainee);
  store_.reset();
  constexpr int kPrograms = 8, kEach = 50, kStep = 25;
  std::vector<std::unique_ptr<test::Process>> programs;
  for (int p = 0; p < kPrograms; ++p) {
    // half of them share a spool
    const auto folder = p % 2 == 0 ? place_.folder : folder_.Path() / ("program" + std::to_string(p));
    programs.push_back(std::make_unique<test::Process>(std::vector<std::string>{
        TROCAR_STORE_WRITER, place_.url, folder, trainee, std::to_string(p * kStep), std::to_string(kEach)}));
  }
  for (auto& program : programs) {
    program->Wait();
    EXPECT_EQ(program->Status(), 0) << program->Err();
  }
  Reopen();
  for (int p = 0; p < kPrograms; ++p) {
    const auto folder = p % 2 == 0 ? place_.folder : folder_.Path() / ("program" + std::to_string(p));
    const DeliveryReport rest = Spool({place_.url, folder}).Deliver(Open());
    EXPECT_FALSE(rest.failure) << rest.failure->Text();
    EXPECT_EQ(rest.damaged + rest.held, 0);
  }
  EXPECT_EQ(Count("attempt"), (kPrograms - 1) * kStep + kEach);
  EXPECT_EQ(Count("(SELECT DISTINCT recording_id FROM attempt) x"), (kPrograms - 1) * kStep + kEach);
  EXPECT_GOOD(Verify(Open()));
}

// A program that was killed between overwriting a delivered attempt and removing it leaves zeros, which are no damaged attempt.
TEST_P(SpoolOver, FinishesAnErasureThatWasCutOff) {
  const fs::path folder = place_.SpoolFolder(), waiting = folder / "waiting.json";
  fs::create_directories(folder);
  std::ofstream(waiting) << std::string(300, '\0');
  ASSERT_EQ(fs::file_size(waiting), 300u);
  const DeliveryReport report = Spool(place_).Deliver(Open());
  EXPECT_FALSE(report.failure) << report.failure->Text();
  EXPECT_EQ(report.damaged, 0);
  EXPECT_FALSE(fs::exists(waiting));
  EXPECT_FALSE(fs::exists(folder / "damaged" / "waiting.json"));
}

// What a killed program has said to be kept is in the store or in the spool.
TEST_P(SpoolOver, LosesNothingWhenTheProgramIsKilled) {
  const std::string trainee = Add(Role::kTrainee);
  store_.reset();
  std::mt19937 random(5);
  std::set<int> kept;
  constexpr int kKills = 12, kMost = 400;
  for (int k = 0; k < kKills; ++k) {
    test::Process program({TROCAR_STORE_WRITER, place_.url, place_.folder, trainee, std::to_string(k * kMost),
                           std::to_string(kMost)});
    const int wanted = static_cast<int>(random() % 12);
    for (int i = 0; i < 12000 && program.Out().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(std::chrono::milliseconds(wanted));
    program.Signal(SIGKILL);
    program.Wait();
    std::istringstream lines(program.Out());
    std::string word;
    for (int number; lines >> word >> number;) kept.insert(number);
  }
  EXPECT_GE(kept.size(), static_cast<std::size_t>(kKills));
  Reopen();
  // the server may still be at the last one's transaction: what is busy is tried again, as the courier does
  DeliveryReport rest = Spool(place_).Deliver(Open());
  for (int i = 0; i < 30 && rest.failure && rest.failure->code == base::ErrorCode::kStoreBusy; ++i)
    rest = Spool(place_).Deliver(Open());
  EXPECT_FALSE(rest.failure) << rest.failure->Text();
  EXPECT_EQ(rest.damaged, 0);
  EXPECT_EQ(rest.held, 0);
  const auto found = Open().GetDatabase().Run("SELECT score FROM attempt");
  ASSERT_TRUE(found.ok()) << found.error().Text();
  std::multiset<int> there;
  for (const Row& row : found->rows) there.insert(static_cast<int>(row.Real(0)));
  for (const int number : kept) EXPECT_EQ(there.count(number), 1u) << number;
  EXPECT_GOOD(Verify(Open()));
}

}  // namespace
}  // namespace trocar::store
