// SPDX-License-Identifier: Apache-2.0
#include "trocar/dataset/dataset.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "trocar/agent/surgeon.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/record/recorder.h"
#include "trocar/scene/task.h"
#include "trocar_test/temporary_folder.h"

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

/// The first seconds of the expert's attempt at seed 1.
void RecordExpert(const fs::path& file, double seconds) {
  fs::create_directories(file.parent_path());
  const auto path = files::FindTask("lift_and_grasp");
  ASSERT_TRUE(path.ok());
  auto read = files::ReadTask(*path, {.seed = 1});
  ASSERT_TRUE(read.ok());
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  auto surgeon = agent::MakeSurgeon("expert", scene, 1);
  ASSERT_TRUE(simulation.ok() && surgeon.ok());
  record::Description description;
  description.kind = record::Description::Kind::kTask;
  description.name = "lift_and_grasp";
  description.level = "normal";
  description.seed = 1;
  record::RecorderSettings settings;
  settings.waits = true;
  auto recorder = record::Recorder::Start(file, description, *simulation, settings);
  ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
  while (simulation->GetSnapshot().time < seconds) {
    const scene::Input input = (*surgeon)->Act(simulation->GetSnapshot());
    simulation->Step(input);
    (*recorder)->Add(input, *simulation);
  }
  ASSERT_TRUE((*recorder)->Finish(*simulation).ok());
}

class DatasetTest : public testing::TestWithParam<Layout> {
 protected:
  /// The first seconds of two operations.
  Plan SmallPlan() const {
    Plan plan;
    plan.layout = GetParam();
    plan.last_seed = 2;
    plan.width = 96, plan.height = 64;
    plan.most_seconds = 2;
    return plan;
  }
  test::TemporaryFolder temporary_;
  fs::path folder_ = temporary_.Path() / "sets";
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

class DatasetOfDemonstrationsTest : public DatasetTest {};

TEST_P(DatasetOfDemonstrationsTest, HoldsStatesAndActionsWithoutPictures) {
  Plan plan = SmallPlan();
  plan.task = "lift_and_grasp";
  plan.every = 0.1;
  plan.has_pictures = false;
  const auto made = WriteDataset(plan, folder_ / "a", nullptr);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  EXPECT_EQ(made->frames, 42U) << "0 to 2 s, twice";
  EXPECT_EQ(Verify(folder_ / "a"), 0);
}

// what was played and recorded gives the frames that the surgeon's own video has
TEST_P(DatasetOfDemonstrationsTest, IsTheSameFromARecording) {
  Plan plan = SmallPlan();
  plan.task = "lift_and_grasp";
  plan.every = 0.5;
  plan.last_seed = 1;
  plan.has_variation = false;
  ASSERT_TRUE(WriteDataset(plan, folder_ / "played", nullptr).ok());

  const fs::path file = folder_ / "attempt.trocar";
  RecordExpert(file, 2.0);
  Plan recorded = plan;
  recorded.recordings = {file};
  const auto made = WriteDataset(recorded, folder_ / "recorded", nullptr);
  ASSERT_TRUE(made.ok()) << made.error().Text();
  EXPECT_EQ(Verify(folder_ / "recorded"), 0);
  EXPECT_EQ(Read(folder_ / "recorded" / "video_00001.h5"), Read(folder_ / "played" / "video_00001.h5"));
}

TEST_P(DatasetOfDemonstrationsTest, RefusesARecordingThatIsCut) {
  const fs::path file = folder_ / "attempt.trocar";
  RecordExpert(file, 1.0);
  const std::string bytes = Read(file);
  std::ofstream(file, std::ios::binary) << bytes.substr(0, bytes.size() - 40);
  Plan plan = SmallPlan();
  plan.recordings = {file};
  const auto made = WriteDataset(plan, folder_ / "a", nullptr);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, base::ErrorCode::kRecordingInvalid) << made.error().Text();
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

INSTANTIATE_TEST_SUITE_P(Layouts, DatasetOfDemonstrationsTest, testing::Values(Layout::kTrocar),
                         [](const auto& layout) { return std::string(NameOf(layout.param)); });

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
  EXPECT_EQ(made.error().code, base::ErrorCode::kFileUnwritable) << made.error().Text();
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  EXPECT_TRUE(!fs::exists(folder_) || fs::is_empty(folder_)) << "half a set stayed";
}

TEST_P(DatasetFaultTest, IsNeverMixedWithAnother) {
  ASSERT_TRUE(host::WriteFile(folder_ / "a" / "mine.txt", "mine").ok());
  const auto made = WriteDataset(SmallPlan(), folder_ / "a", nullptr);
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, base::ErrorCode::kFileUnwritable);
  EXPECT_EQ(Read(folder_ / "a" / "mine.txt"), "mine");
}

TEST_P(DatasetFaultTest, RefusesPlansThatCannotBe) {
  const auto code_of = [&](auto change) {
    Plan plan = SmallPlan();
    change(plan);
    const auto made = WriteDataset(plan, folder_ / "a", nullptr);
    return made.ok() ? base::ErrorCode::kNone : made.error().code;
  };
  EXPECT_EQ(code_of([](Plan& p) { p.last_seed = 0; }), base::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.width = 8; }), base::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.layout = Layout::kCholec80, p.every = 2; }), base::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.has_pictures = false; }), base::ErrorCode::kUsage);
  EXPECT_EQ(code_of([](Plan& p) { p.recordings = {"/nowhere.trocar"}; }), base::ErrorCode::kFileMissing);
  EXPECT_EQ(code_of([](Plan& p) { p.surgeon = "nobody"; }), base::ErrorCode::kUnknownName);
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

INSTANTIATE_TEST_SUITE_P(Layouts, DatasetFaultTest, testing::Values(Layout::kCholecSeg8k),
                         [](const auto& layout) { return std::string(NameOf(layout.param)); });

}  // namespace
}  // namespace trocar::dataset
