// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/attempt_filing.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "recorded_attempt.h"
#include "trocar/host/safe_file.h"
#include "trocar/store/attempts.h"
#include "trocar/store/spool.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::centre {
namespace {

constexpr const char* kTask = "instrument_navigation";

class Filing : public testing::Test {
 protected:
  void SetUp() override {
    access_.place = {folder_.Path() / "store.sqlite", folder_.Path() / "files"};
    recording_ = folder_.Path() / "attempt.trocar";
  }
  /// Waits until nothing is measured and nothing waits, for a minute at most.
  static bool Settles(AttemptFiling& filing) {
    for (int i = 0; i < 1200; ++i) {
      const FilingStatus now = filing.Status();
      if (now.measuring == 0 && now.waiting == 0) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  void Record(std::uint64_t ticks, const std::string& player = "mouse and keyboard") const {
    test::RecordAttempt(recording_, test::DescribeTask(kTask, "easy", 3, player), {"novice", 3, ticks, {}});
  }
  std::vector<store::StoredAttempt> Stored() {
    auto desk = OpenDesk(access_);
    EXPECT_TRUE(desk.ok()) << (desk.ok() ? "" : desk.error().Text());
    if (!desk.ok()) return {};
    auto page = store::ListAttempts(desk->store, desk->viewer, {});
    EXPECT_TRUE(page.ok());
    return page.ok() ? page->attempts : std::vector<store::StoredAttempt>{};
  }
  std::size_t CountNotes() const {
    std::size_t count = 0;
    std::error_code ignored;
    for (const auto& entry :
         std::filesystem::directory_iterator(access_.place.SpoolFolder() / "unmeasured", ignored))
      count += entry.path().extension() == ".json" ? 1 : 0;
    return count;
  }
  void AddTrainee(const std::string& pseudonym) {
    auto desk = OpenDesk(access_);
    ASSERT_TRUE(desk.ok());
    ASSERT_TRUE(store::AddPerson(desk->store, desk->viewer, store::Role::kTrainee, pseudonym).ok());
  }

  test::TemporaryFolder folder_;
  Access access_;
  std::filesystem::path recording_;
};

TEST_F(Filing, BringsAnAttemptWithItsMetricsIntoTheStoreByItself) {
  AddTrainee("T-AAAAAA");
  AttemptFiling filing(access_, 1, [] {});
  filing.SetPerson("T-AAAAAA");
  filing.Begin(recording_);
  Record(600);
  filing.SetPerson("");  // somebody leaves while it is measured: it stays whose it was
  filing.End(recording_);
  ASSERT_TRUE(Settles(filing));
  const auto filed = filing.TakeFiled();
  ASSERT_EQ(filed.size(), 1u);
  ASSERT_TRUE(filed[0].judged.has_value()) << filed[0].failure->Text();
  const auto stored = Stored();
  ASSERT_EQ(stored.size(), 1u);
  EXPECT_EQ(stored[0].attempt.trainee, "T-AAAAAA");
  EXPECT_EQ(stored[0].attempt.task, kTask);
  EXPECT_FALSE(stored[0].attempt.is_completed);
  EXPECT_EQ(stored[0].attempt.mark.state, store::Verification::kRecordedHere);
  auto desk = OpenDesk(access_);
  ASSERT_TRUE(desk.ok());
  const auto whole = store::FindAttempt(desk->store, desk->viewer, stored[0].id);
  ASSERT_TRUE(whole.ok());
  EXPECT_GT(whole->attempt.metrics.size(), 20u);
  EXPECT_EQ(CountNotes(), 0u);
}

// What is played next is nobody's step: the step belongs to the attempt, not to the window.
TEST_F(Filing, NotesTheStepOfTheAttemptThatWasMadeForIt) {
  AttemptFiling filing(access_, 1, [] {});
  const StepName step{"basic-skills", "instruments"};
  filing.Begin(recording_, step);
  filing.Begin(folder_.Path() / "next.trocar");
  Record(300);
  filing.End(recording_);
  test::RecordAttempt(folder_.Path() / "next.trocar", test::DescribeTask(kTask, "easy", 4),
                      {"novice", 4, 300, {}});
  filing.End(folder_.Path() / "next.trocar");
  ASSERT_TRUE(Settles(filing));
  auto desk = OpenDesk(access_);
  ASSERT_TRUE(desk.ok());
  const auto stored = Stored();
  ASSERT_EQ(stored.size(), 2u);
  for (const store::StoredAttempt& one : stored) {
    const auto whole = store::FindAttempt(desk->store, desk->viewer, one.id);
    ASSERT_TRUE(whole.ok());
    EXPECT_EQ(FindStepName(whole->attempt), whole->attempt.seed == 3 ? step : StepName()) << one.attempt.seed;
  }
}

TEST_F(Filing, KnowsWhoseAnAttemptIsWhereItCannotBeNoted) {
  AddTrainee("T-AAAAAA");
  ASSERT_TRUE(
      host::WriteFile(access_.place.SpoolFolder() / "unmeasured", "a file where the folder should be").ok());
  AttemptFiling filing(access_, 1, [] {});
  filing.SetPerson("T-AAAAAA");
  filing.Begin(recording_);
  Record(300);
  filing.SetPerson("");
  filing.End(recording_);
  ASSERT_TRUE(Settles(filing));
  ASSERT_EQ(Stored().size(), 1u);
  EXPECT_EQ(Stored()[0].attempt.trainee, "T-AAAAAA");
}

TEST_F(Filing, GoesOnWithWhatAProgramThatDiedHasLeft) {
  {
    AttemptFiling killed(access_, 1, [] {});
    killed.Begin(recording_);
    Record(300);
    // it ends without having been told that the attempt has
  }
  ASSERT_EQ(CountNotes(), 1u);
  AttemptFiling next(access_, 1, [] {});
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  ASSERT_TRUE(Settles(next));
  EXPECT_EQ(Stored().size(), 1u);
  EXPECT_EQ(CountNotes(), 0u);
}

TEST_F(Filing, LeavesAloneWhatAnotherProgramIsAt) {
  AttemptFiling first(access_, 1, [] {});
  first.Begin(recording_);
  Record(300);
  for (int i = 0; i < 200 && CountNotes() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ASSERT_EQ(CountNotes(), 1u);
  AttemptFiling second(access_, 1, [] {});
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_EQ(second.Status().measuring, 0u);
  EXPECT_EQ(CountNotes(), 1u);
}

TEST_F(Filing, SpoolsWhileTheStoreIsAwayAndSaysSo) {
  access_.place.url = folder_.Path() / "no" / "store.sqlite";
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "no", "a file where the folder should be").ok());
  AttemptFiling filing(access_, 1, [] {});
  filing.Begin(recording_);
  Record(300);
  filing.End(recording_);
  for (int i = 0; i < 1200 && (filing.Status().waiting == 0 || !filing.Status().failure); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(filing.Status().waiting, 1u);
  ASSERT_TRUE(filing.Status().failure.has_value());
  // it is there again
  std::filesystem::remove(folder_.Path() / "no");
  ASSERT_TRUE(Settles(filing)) << filing.Status().failure->Text();
  EXPECT_EQ(Stored().size(), 1u);
}

TEST_F(Filing, DoesNotStoreADemonstration) {
  AttemptFiling filing(access_, 1, [] {});
  Record(300, "the demonstration");
  filing.Begin(recording_);
  filing.End(recording_);
  ASSERT_TRUE(Settles(filing));
  const auto filed = filing.TakeFiled();
  ASSERT_EQ(filed.size(), 1u);
  EXPECT_TRUE(filed[0].judged && filed[0].judged->is_demonstration);
  EXPECT_TRUE(Stored().empty());
}

TEST_F(Filing, SaysThatAnAttemptOfNoLengthIsNotKept) {
  AttemptFiling filing(access_, 1, [] {});
  filing.Begin(recording_);
  filing.End(recording_);
  ASSERT_TRUE(Settles(filing));
  const auto filed = filing.TakeFiled();
  ASSERT_EQ(filed.size(), 1u);
  ASSERT_TRUE(filed[0].failure.has_value());
  EXPECT_EQ(filed[0].failure->code, base::ErrorCode::kFileMissing);
  EXPECT_EQ(CountNotes(), 0u);
}

TEST_F(Filing, ErasingAPersonFindsWhatIsNotMeasuredYet) {
  AddTrainee("T-BBBBBB");
  {
    AttemptFiling killed(access_, 1, [] {});
    killed.SetPerson("T-BBBBBB");
    killed.Begin(recording_);
  }
  ASSERT_EQ(CountNotes(), 1u);
  const auto erased = store::Spool(access_.place).Erase("T-BBBBBB");
  ASSERT_TRUE(erased.ok());
  EXPECT_EQ(*erased, 1);
  EXPECT_EQ(CountNotes(), 0u);
}

}  // namespace
}  // namespace trocar::centre
