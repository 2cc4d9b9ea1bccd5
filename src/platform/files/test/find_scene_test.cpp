// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/find_scene.h"

#include <gtest/gtest.h>

#include <string>

#include "trocar/host/data_folder.h"
#include "trocar/host/safe_file.h"

namespace trocar::files {
namespace {

std::filesystem::path DataFile(const std::string& name) {
  const auto data = host::FindDataFolder();
  EXPECT_TRUE(data.ok());
  return data.ok() ? *data / name : std::filesystem::path();
}

/// A delivered file in which one text is another.
std::string ReadChanged(const std::filesystem::path& path, const std::string& from, const std::string& to) {
  auto text = host::ReadFile(path);
  EXPECT_TRUE(text.ok()) << path;
  const std::size_t at = text.ok() ? text->find(from) : std::string::npos;
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? std::string() : text->replace(at, from.size(), to);
}

TEST(FindScene, FindsOperationsAndTasks) {
  const auto operation = FindScene("cholecystectomy", {"easy", 5, {}});
  ASSERT_TRUE(operation.ok()) << operation.error().Text();
  EXPECT_TRUE(operation->operation && !operation->task);
  EXPECT_EQ(operation->operation->level.key, "easy");
  EXPECT_EQ(operation->seed, 5u);

  const auto task = FindScene("peg_transfer", {"normal", 7, {}});
  ASSERT_TRUE(task.ok()) << task.error().Text();
  EXPECT_TRUE(task->task && !task->operation);
  EXPECT_EQ(task->seed, 7u);

  // in a scene to look at nothing is to be done
  EXPECT_EQ(FindScene(DataFile("scenes/retraction.json")).error().code, base::ErrorCode::kJsonField);
  EXPECT_EQ(FindScene("juggling").error().code, base::ErrorCode::kUnknownName);
  EXPECT_EQ(FindScene("cholecystectomy", {"heroic", 1, {}}).error().code, base::ErrorCode::kUnknownName);
}

TEST(FindScene, ReadsWhatStandsInNoFile) {
  const auto file = DataFile("scenes/tasks/peg_transfer.json");
  const auto written = ReadTask(file);
  const auto changed = ParseScene(ReadChanged(file, "\"mass_g\": 2", "\"mass_g\": 8"), file);
  ASSERT_TRUE(written.ok() && changed.ok()) << changed.error().Text();
  EXPECT_EQ(changed->objects.size(), written->objects.size());
  EXPECT_DOUBLE_EQ(changed->objects[0].body.mass, 4 * written->objects[0].body.mass);
  EXPECT_TRUE(changed->task);

  // its patient and materials lie where the source's folder says
  const auto scene = DataFile("scenes/cholecystectomy.json");
  const std::string text = ReadChanged(scene, "\"name\": \"", "\"name\": \"Another ");
  const auto operation = ParseScene(text, scene, {"hard", 3, {}});
  ASSERT_TRUE(operation.ok()) << operation.error().Text();
  EXPECT_TRUE(operation->name.starts_with("Another "));
  EXPECT_EQ(operation->operation->level.key, "hard");
  EXPECT_EQ(operation->seed, 3u);
}

TEST(FindScene, ReadsAlsoAScenesTextInWhichNothingIsToBeDone) {
  const auto file = DataFile("scenes/retraction.json");
  const auto plain =
      ParseScene(ReadChanged(file, "\"tick_hz\": 120", "\"tick_hz\": 60"), file, {"normal", 9, {}});
  ASSERT_TRUE(plain.ok()) << plain.error().Text();
  EXPECT_TRUE(!plain->task && !plain->operation);
  EXPECT_EQ(plain->seed, 9u);
  EXPECT_DOUBLE_EQ(plain->tick_seconds, 1.0 / 60);
}

TEST(FindScene, RefusalsNameTheSourceAndTheField) {
  const auto file = DataFile("scenes/tasks/peg_transfer.json");
  const auto heavy = ParseScene(ReadChanged(file, "\"mass_g\": 2", "\"mass_g\": -2"), "my task");
  ASSERT_FALSE(heavy.ok());
  EXPECT_NE(heavy.error().message.find("my task"), std::string::npos) << heavy.error().message;
  EXPECT_NE(heavy.error().message.find("mass_g"), std::string::npos) << heavy.error().message;
  EXPECT_EQ(ParseScene("{", "my task").error().code, base::ErrorCode::kJsonSyntax);
  EXPECT_FALSE(ParseScene("{}", "my task").ok());
  EXPECT_FALSE(ParseScene("[]", "my task").ok());
}

}  // namespace
}  // namespace trocar::files
