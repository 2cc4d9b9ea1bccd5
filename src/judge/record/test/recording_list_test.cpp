// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recording_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "recorded_scene.h"
#include "trocar/host/safe_file.h"

namespace trocar::record {
namespace {

class RecordingListTest : public RecordedScene {};

TEST_F(RecordingListTest, SaysWhatTheWholeRecordingSays) {
  Record(250);
  const auto whole = ReadRecording(File());
  const auto summary = ReadSummary(File());
  ASSERT_TRUE(whole.ok() && summary.ok());
  EXPECT_EQ(summary->description.name, whole->description.name);
  EXPECT_EQ(summary->description.player, "a test");
  EXPECT_DOUBLE_EQ(summary->seconds, whole->Seconds());
  EXPECT_TRUE(summary->is_finished);
  EXPECT_TRUE(summary->is_whole);
  EXPECT_EQ(summary->outcome, whole->ending->outcome);
  EXPECT_EQ(summary->bytes, whole->file_bytes);
}

TEST_F(RecordingListTest, ListsTheNewestFirstAndLeavesOutWhatIsNone) {
  Record(100);
  std::filesystem::rename(File(), folder_ / "old.trocar");
  Record(100);
  std::filesystem::rename(File(), folder_ / "new.trocar");
  Write("cut.trocar", host::ReadFile(folder_ / "new.trocar")->substr(0, 4000));
  Write("none.trocar", "text");
  Write("new.trocar.index", "an index");
  const auto now = std::filesystem::file_time_type::clock::now();
  std::filesystem::last_write_time(folder_ / "old.trocar", now - std::chrono::hours(2));
  std::filesystem::last_write_time(folder_ / "cut.trocar", now - std::chrono::hours(1));
  std::filesystem::last_write_time(folder_ / "new.trocar", now);
  const auto list = ListRecordings(folder_);
  std::vector<std::string> names;
  for (const RecordingSummary& entry : list) names.push_back(entry.path.filename());
  EXPECT_THAT(names, testing::ElementsAre("new.trocar", "cut.trocar", "old.trocar"));
  EXPECT_FALSE(list[1].is_whole);
  EXPECT_FALSE(list[1].is_finished);
  EXPECT_TRUE(ListRecordings(folder_ / "missing").empty());
}

TEST_F(RecordingListTest, RefusesWhatReadRecordingRefuses) {
  Record(60);
  const std::string whole = *host::ReadFile(File());
  const auto refuses = [&](const std::string& bytes, const char* why) {
    Write("bad.trocar", bytes);
    const auto summary = ReadSummary(folder_ / "bad.trocar");
    EXPECT_FALSE(summary.ok());
    if (summary.ok()) return;
    EXPECT_EQ(summary.error().code, base::ErrorCode::kRecordingInvalid);
    EXPECT_THAT(summary.error().message, testing::HasSubstr(why));
    const auto read = ReadRecording(folder_ / "bad.trocar");
    EXPECT_FALSE(read.ok());
  };
  refuses("text", "no recording");
  std::string future = whole;
  future[8] = 9;
  refuses(future, "newer one");
  std::string turned = whole;
  turned[20] = static_cast<char>(turned[20] ^ 1);
  refuses(turned, "header");
  refuses(whole.substr(0, 30), "description");
  const auto missing = ReadSummary(folder_ / "missing.trocar");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, base::ErrorCode::kFileMissing);
}

TEST(DescribeOutcome, IsForAPerson) {
  EXPECT_EQ(DescribeOutcome(R"({"seconds":3,"task":{"phase":"completed","score":87.34}})"),
            "completed, score 87.3");
  EXPECT_EQ(DescribeOutcome(R"({"seconds":3,"task":{"phase":"time_over","score":12.34}})"), "time over");
  EXPECT_EQ(DescribeOutcome(R"({"operation":{"completed":true,"critical_view":true,"blood_ml":40.2}})"),
            "completed, critical view, 40 mL of blood");
  EXPECT_EQ(DescribeOutcome(R"({"seconds":3})"), "");
  EXPECT_EQ(DescribeOutcome("no JSON"), "");
}

}  // namespace
}  // namespace trocar::record
