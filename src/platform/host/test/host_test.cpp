// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "trocar/base/error_codes.h"
#include "trocar/host/beat_watch.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::host {
namespace {

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
  EXPECT_EQ(ReadFile(folder_.Path() / "absent").error().code, base::ErrorCode::kFileMissing);
  EXPECT_EQ(ReadFile(folder_.Path()).error().code, base::ErrorCode::kFileUnreadable);
  ASSERT_TRUE(WriteFile(folder_.Path() / "long", "12345").ok());
  EXPECT_EQ(ReadFile(folder_.Path() / "long", 4).error().code, base::ErrorCode::kFileTooLarge);
  EXPECT_EQ(WriteFile(folder_.Path() / "long" / "below-a-file", "x").error().code,
            base::ErrorCode::kFileUnwritable);
}

}  // namespace
}  // namespace trocar::host
