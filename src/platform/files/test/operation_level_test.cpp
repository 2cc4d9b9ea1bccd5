// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/operation_level_file.h"

#include <gtest/gtest.h>

#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/scene/scene.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::files {
namespace {

scene::Scene ReadAt(const std::string& level) {
  auto scene = FindOperation("cholecystectomy", {}, 1, level);
  EXPECT_TRUE(scene.ok() && scene->has_value()) << level;
  return scene.ok() && *scene ? std::move(**scene) : scene::Scene{};
}

base::Result<std::vector<scene::OperationLevel>> ReadText(const std::string& levels) {
  const test::TemporaryFolder folder;
  const auto path = folder.Path() / "levels.json";
  EXPECT_TRUE(host::WriteFile(
                  path, R"({"format": "trocar-operation-levels", "version": 1, "levels": )" + levels + "}")
                  .ok());
  return ReadOperationLevels(path);
}

// What was measured, recorded and hashed before there were levels holds at the normal one.
TEST(OperationLevels, LeaveTheNormalOperationAsItIs) {
  const scene::Scene plain = ReadAt(""), normal = ReadAt(scene::kNormalLevel);
  EXPECT_TRUE(plain.operation->parameters == scene::OperationParameters{});
  EXPECT_TRUE(normal.operation->parameters == plain.operation->parameters);
  EXPECT_EQ(normal.settings, plain.settings);
  EXPECT_EQ(normal.operation->level, plain.operation->level);
  EXPECT_EQ(plain.operation->level.key, "normal");
}

TEST(OperationLevels, ChangeCameraBleedingHelpAndTime) {
  const scene::Scene easy = ReadAt("easy"), normal = ReadAt("normal"), hard = ReadAt("hard");
  EXPECT_TRUE(easy.settings.holds_camera);
  EXPECT_FALSE(normal.settings.holds_camera);
  EXPECT_FALSE(hard.settings.holds_camera);
  const auto oozes = [](const scene::Scene& scene) { return scene.operation->parameters.bed.bed_volume; };
  const auto bleeds = [](const scene::Scene& scene) {
    return scene.operation->parameters.supplies.aorta.conductance;
  };
  EXPECT_LT(oozes(easy), oozes(normal));
  EXPECT_LT(oozes(normal), oozes(hard));
  EXPECT_LT(bleeds(easy), bleeds(normal));
  EXPECT_LT(bleeds(normal), bleeds(hard));
  EXPECT_TRUE(normal.operation->level.has_guidance);
  EXPECT_FALSE(hard.operation->level.has_guidance);
  EXPECT_GT(normal.operation->level.time_limit, 1e9);
  EXPECT_EQ(hard.operation->level.time_limit, 2700);
}

TEST(OperationLevels, NameThoseThereAre) {
  const auto found = FindOperation("cholecystectomy", {}, 1, "heroic");
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, base::ErrorCode::kUnknownName);
  EXPECT_NE(found.error().message.find("easy, normal, hard"), std::string::npos) << found.error().message;
}

TEST(OperationLevels, AreRefusedWhereTheyAreWrong) {
  EXPECT_TRUE(ReadText(R"([{"key": "normal", "about": "as it is"}])").ok());
  EXPECT_FALSE(ReadText(R"([{"key": "easy", "about": "no normal"}])").ok());
  EXPECT_FALSE(ReadText(R"([{"key": "normal", "about": "a"}, {"key": "normal", "about": "b"}])").ok());
  EXPECT_FALSE(ReadText(R"([{"key": "normal", "about": "a", "scene": {"tick_hz": 60}}])").ok());
  EXPECT_FALSE(ReadText(R"([{"key": "normal", "about": "a", "time": 3}])").ok());
  EXPECT_FALSE(ReadText(R"([{"key": "normal", "about": "a", "time_limit_s": 1}])").ok());
}

}  // namespace
}  // namespace trocar::files
