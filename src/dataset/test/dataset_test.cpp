// SPDX-License-Identifier: Apache-2.0
#include "trocar/dataset/dataset.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "trocar/core/safe_file.h"

namespace trocar::dataset {
namespace {

namespace fs = std::filesystem;

std::string Read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Of the reader, which is Python and shares no code with what wrote the set.
int Verify(const fs::path& folder) {
  const std::string command = std::string("python3 ") + TROCAR_VERIFY_DATASET + " " + folder.string();
  return std::system(command.c_str());
}

class DatasetTest : public testing::TestWithParam<Layout> {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("dataset_" + std::string(NameOf(GetParam())));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  /// The first seconds of two operations.
  Plan SmallPlan() const {
    Plan plan;
    plan.layout = GetParam();
    plan.last_seed = 2;
    plan.width = 96, plan.height = 64;
    plan.most_seconds = 2;
    return plan;
  }
  fs::path folder_;
};

TEST_P(DatasetTest, IsReadByAnotherProgramAndIsTheSameAgain) {
  Plan plan = SmallPlan();
  const auto made = WriteDataset(plan, folder_ / "a", nullptr);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  EXPECT_EQ(made->videos, 2U);
  EXPECT_EQ(made->frames, 6U) << "at 0, 1 and 2 s";
  EXPECT_EQ(Verify(folder_ / "a"), 0);
  plan.jobs = 2;
  const auto again = WriteDataset(plan, folder_ / "b", nullptr);
  ASSERT_TRUE(again.ok()) << again.error().Text();
  EXPECT_EQ(again->hash, made->hash);
  for (const char* file : {"SHA256SUMS", "card.json", "README.md"})
    EXPECT_EQ(Read(folder_ / "a" / file), Read(folder_ / "b" / file)) << file;
}

INSTANTIATE_TEST_SUITE_P(Layouts, DatasetTest, testing::ValuesIn(kLayouts),
                         [](const auto& layout) { return std::string(NameOf(layout.param)); });

class DatasetFaultTest : public DatasetTest {};

TEST_P(DatasetFaultTest, IsFoundOutWhenAByteWasChanged) {
  Plan plan = SmallPlan();
  plan.last_seed = 1;
  ASSERT_TRUE(WriteDataset(plan, folder_ / "a", nullptr).ok());
  fs::path mask;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "a"))
    if (entry.path().string().ends_with("watershed_mask.png")) mask = entry.path();
  std::string bytes = Read(mask);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  std::ofstream(mask, std::ios::binary) << bytes;
  EXPECT_NE(Verify(folder_ / "a"), 0);
}

TEST_P(DatasetFaultTest, LeavesNothingWhereTheDiskIsFull) {
  // as a full disk does it: a file cannot grow beyond a limit
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 3000;
  setrlimit(RLIMIT_FSIZE, &small);
  const auto made = WriteDataset(SmallPlan(), folder_ / "a", nullptr);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, core::ErrorCode::kFileUnwritable) << made.error().Text();
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  EXPECT_TRUE(!fs::exists(folder_) || fs::is_empty(folder_)) << "half a set stayed";
}

TEST_P(DatasetFaultTest, IsNeverMixedWithAnother) {
  ASSERT_TRUE(core::WriteFile(folder_ / "a" / "mine.txt", "mine").ok());
  const auto made = WriteDataset(SmallPlan(), folder_ / "a", nullptr);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, core::ErrorCode::kFileUnwritable);
  EXPECT_EQ(Read(folder_ / "a" / "mine.txt"), "mine");
}

TEST_P(DatasetFaultTest, RefusesPlansThatCannotBe) {
  const auto code_of = [&](auto change) {
    Plan plan = SmallPlan();
    change(plan);
    const auto made = WriteDataset(plan, folder_ / "a", nullptr);
    return made.ok() ? core::ErrorCode::kNone : made.error().code;
  };
  EXPECT_EQ(code_of([](Plan& p) { p.last_seed = 0; }), core::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.width = 8; }), core::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.layout = Layout::kCholec80, p.every = 2; }), core::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.surgeon = "nobody"; }), core::ErrorCode::kUnknownName);
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

INSTANTIATE_TEST_SUITE_P(Layouts, DatasetFaultTest, testing::Values(Layout::kCholecSeg8k),
                         [](const auto& layout) { return std::string(NameOf(layout.param)); });

}  // namespace
}  // namespace trocar::dataset
