// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/scene_choice.h"

#include <gtest/gtest.h>

namespace trocar::presenter {
namespace {

base::Result<scene::Scene> Read(const std::string& task) {
  Options options;
  options.task = task;
  options.seed = 5;
  return ReadChosenScene(options);
}

TEST(ReadChosenScene, OpensTheOperationThatPlayKnows) {
  const auto scene = Read("cholecystectomy");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_TRUE(scene->HasPatient());
  EXPECT_FALSE(scene->task);
  EXPECT_EQ(scene->seed, 5u);
}

TEST(ReadChosenScene, OpensATask) {
  const auto scene = Read("peg_transfer");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_TRUE(scene->task);
}

TEST(ReadChosenScene, OpensTheDemonstrationWhereNothingIsNamed) {
  const auto scene = ReadChosenScene(Options{});
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  EXPECT_FALSE(scene->script.keys.empty());
}

TEST(ReadChosenScene, RefusesWhatNobodyKnows) {
  const auto scene = Read("appendectomy");
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, base::ErrorCode::kUnknownName);
  EXPECT_NE(scene.error().message.find("cholecystectomy"), std::string::npos);
  // a scene without an operation is no task, and no operation
  EXPECT_EQ(Read("retraction").error().code, base::ErrorCode::kUnknownName);
}

}  // namespace
}  // namespace trocar::presenter
