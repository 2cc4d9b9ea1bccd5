// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "trocar/core/beat_watch.h"
#include "trocar/core/error_codes.h"
#include "trocar/core/result.h"
#include "trocar/core/safe_file.h"
#include "trocar/core/state_hash.h"
#include "trocar/core/statistics.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::core {
namespace {

TEST(ErrorTable, HasOneEntryPerCodeInOrderWithUniqueText) {
  std::set<std::string_view> texts;
  int index = 0;
  for (const ErrorEntry& entry : ErrorTable()) {
    EXPECT_EQ(static_cast<int>(entry.code), index++);
    EXPECT_TRUE(texts.insert(entry.text).second) << entry.text;
    EXPECT_FALSE(entry.meaning.empty());
  }
}

TEST(Result, HoldsAValueOrAnError) {
  const Result<int> good = 7;
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(*good, 7);
  const Result<int> bad = Error{ErrorCode::kImageSliceMissing, "slice 0561 is missing"};
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().Text(), "E-IMG-002 slice 0561 is missing");
}

TEST(BeatWatch, CountsNoMoreThanALongLookBetweenTwoLooks) {
  BeatWatch watch(2000);
  watch.Forget(100'000);
  EXPECT_EQ(watch.Look(0, 101'000), 1000) << "no beat yet is silence, too";
  EXPECT_EQ(watch.Look(5, 102'000), 0);
  EXPECT_EQ(watch.Look(5, 103'000), 1000);
  EXPECT_EQ(watch.Look(5, 105'000), 3000);
  EXPECT_EQ(watch.Look(5, 155'000), 5000) << "the watcher itself was away";
  EXPECT_EQ(watch.Look(4, 156'000), 0) << "any change is a beat";
  EXPECT_EQ(watch.Look(4, 157'000), 1000);
  watch.Forget(158'000);
  EXPECT_EQ(watch.Look(4, 158'500), 500);
}

TEST(CalcPercentile, InterpolatesBetweenRanks) {
  EXPECT_DOUBLE_EQ(CalcPercentile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(CalcPercentile({4, 1, 3, 2}, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(CalcPercentile({}, 0.5), 0.0);
}

TEST(StateHash, ChangesWithTheLastBitAndTheOrder) {
  StateHash a, b, c;
  a.Add(1.0);
  a.Add(2.0);
  b.Add(1.0);
  b.Add(2.0000000000000004);
  c.Add(2.0);
  c.Add(1.0);
  EXPECT_NE(a.Value(), b.Value());
  EXPECT_NE(a.Value(), c.Value());
  EXPECT_EQ(a.Text().size(), 16u);
}

class SafeFile : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

TEST_F(SafeFile, ReadsBackWhatItWroteAndLeavesNothingElse) {
  ASSERT_TRUE(WriteFile(folder_.Path() / "deep" / "a.txt", "one").ok());
  ASSERT_TRUE(WriteFile(folder_.Path() / "deep" / "a.txt", "two").ok());
  EXPECT_EQ(*ReadFile(folder_.Path() / "deep" / "a.txt"), "two");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.Path() / "deep"), {}), 1);
}

TEST_F(SafeFile, NamesWhatIsWrong) {
  EXPECT_EQ(ReadFile(folder_.Path() / "absent").error().code, ErrorCode::kFileMissing);
  EXPECT_EQ(ReadFile(folder_.Path()).error().code, ErrorCode::kFileUnreadable);
  ASSERT_TRUE(WriteFile(folder_.Path() / "long", "12345").ok());
  EXPECT_EQ(ReadFile(folder_.Path() / "long", 4).error().code, ErrorCode::kFileTooLarge);
  EXPECT_EQ(WriteFile(folder_.Path() / "long" / "below-a-file", "x").error().code,
            ErrorCode::kFileUnwritable);
}

}  // namespace
}  // namespace trocar::core
