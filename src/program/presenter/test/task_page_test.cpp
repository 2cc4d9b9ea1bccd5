// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/task_page.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace trocar::presenter {
namespace {

TaskPage Load(TaskSection section, const std::filesystem::path& patient = {}) {
  auto page = LoadTaskPage(section, patient);
  EXPECT_TRUE(page.ok()) << page.error().Text();
  return page.ok() ? std::move(*page) : TaskPage{};
}

TEST(TaskPages, HaveTheBasicSkillsTheEasiestFirst) {
  const TaskPage page = Load(TaskSection::kBasicSkills);
  ASSERT_EQ(page.groups.size(), 1u);
  const auto& rows = page.groups[0].rows;
  ASSERT_EQ(rows.size(), 10u);
  EXPECT_EQ(rows.front().request.task, "camera_navigation_0");
  EXPECT_EQ(rows.back().request.task, "clip_and_cut");
  std::set<std::string> keys;
  for (const TaskPage::Row& row : rows) keys.insert(row.request.task);
  EXPECT_EQ(keys.size(), rows.size());
}

TEST(TaskPages, TasksAndPartsHaveSmallPictures) {
  for (const TaskPage::Group& group : Load(TaskSection::kAll).groups) {
    for (const TaskPage::Row& row : group.rows) {
      // a scene that is no task has none
      if (row.request.task.empty()) continue;
      ASSERT_FALSE(row.picture.empty()) << row.name;
      EXPECT_LT(std::filesystem::file_size(row.picture), 60000u) << row.picture;
    }
  }
}

TEST(TaskPages, HaveTheOperationAndItsPartsOnThePatientWithLevels) {
  const TaskPage page = Load(TaskSection::kOperation, "/patients/seed-7");
  ASSERT_EQ(page.groups.size(), 1u);
  EXPECT_NE(page.groups[0].title.find("generated patient 7"), std::string::npos);
  const auto& rows = page.groups[0].rows;
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].request.part, "");
  EXPECT_EQ(rows[3].request.part, "bed");
  for (const TaskPage::Row& row : rows) {
    EXPECT_EQ(row.request.task, "cholecystectomy");
    EXPECT_EQ(row.request.choice.patient_folder, "/patients/seed-7");
    ASSERT_EQ(row.levels.size(), 3u);
    EXPECT_EQ(row.levels[0].key, "easy");
    EXPECT_FALSE(row.levels[2].about.empty()) << "what differs is said";
  }
}

TEST(TaskPages, SayOnesBestResultAtEachLevel) {
  TaskPage page = Load(TaskSection::kAll);
  centre::BestResults best;
  best[{"peg_transfer", "normal"}] = {3, 2, 0, 91.5, 84.0, true};
  best[{"cholecystectomy", ""}] = {1, 1, 0, std::nullopt, 600.0, false};
  AddBestResults(best, page);
  int said = 0;
  for (const TaskPage::Group& group : page.groups) {
    for (const TaskPage::Row& row : group.rows) {
      for (const TaskPage::Level& level : row.levels) {
        if (row.request.task == "peg_transfer" && level.key == "normal")
          said += level.best == "Best 91.5 %, 1:24; 3 attempts" ? 1 : 100;
        if (row.request.task == "cholecystectomy" && row.request.part.empty() && level.key == "normal")
          said += level.best == "Best 10:00; 1 attempt" ? 1 : 100;
        if (row.request.task == "wire_run") {
          EXPECT_EQ(level.best, "Not tried yet");
        }
      }
    }
  }
  EXPECT_EQ(said, 2);
}

}  // namespace
}  // namespace trocar::presenter
