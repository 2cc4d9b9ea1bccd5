// SPDX-License-Identifier: Apache-2.0
#include "trocar/app/options.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace trocar::app {
namespace {

core::Result<Command> Parse(std::initializer_list<const char*> arguments) {
  std::vector<const char*> argv{"trocar-window"};
  argv.insert(argv.end(), arguments);
  return ParseCommandLine(static_cast<int>(argv.size()), argv.data());
}

TEST(Options, DefaultsOpenTheBuiltInSceneInAWindow) {
  const core::Result<Command> command = Parse({});
  ASSERT_TRUE(command.ok());
  EXPECT_FALSE(command->is_text_only);
  EXPECT_TRUE(command->options.scene.empty());
  EXPECT_TRUE(command->options.screenshot.empty());
  EXPECT_FALSE(command->options.is_fullscreen);
}

TEST(Options, ReadsEveryOption) {
  const core::Result<Command> command = Parse({"--scene", "a.json", "--threads", "2", "--fullscreen",
                                               "--demonstration", "--screenshot", "b.png", "--after", "1.5"});
  ASSERT_TRUE(command.ok());
  EXPECT_EQ(command->options.scene, "a.json");
  EXPECT_EQ(command->options.threads, 2);
  EXPECT_TRUE(command->options.is_fullscreen);
  EXPECT_TRUE(command->options.is_demonstration);
  EXPECT_EQ(command->options.screenshot, "b.png");
  EXPECT_EQ(command->options.screenshot_after, 1.5);
}

TEST(Options, HelpAndVersionArePrinted) {
  const core::Result<Command> help = Parse({"--help"});
  ASSERT_TRUE(help.ok());
  EXPECT_TRUE(help->is_text_only);
  EXPECT_NE(help->text.find("--scene"), std::string::npos);
  const core::Result<Command> version = Parse({"--version"});
  ASSERT_TRUE(version.ok());
  EXPECT_EQ(version->text.find("trocar-window "), 0u);
}

TEST(Options, WrongOnesNameTheRemedy) {
  for (const auto& arguments :
       std::initializer_list<std::initializer_list<const char*>>{{"--nonsense"},
                                                                 {"--threads", "-1"},
                                                                 {"--threads", "many"},
                                                                 {"--after", "nan", "--screenshot", "a.png"},
                                                                 {"--after", "2"},
                                                                 {"--scene"}}) {
    const core::Result<Command> command = Parse(arguments);
    ASSERT_FALSE(command.ok());
    EXPECT_EQ(command.error().code, core::ErrorCode::kUsage);
    EXPECT_NE(command.error().message.find("trocar-window --help"), std::string::npos);
  }
}

TEST(Options, ThreadsLeaveProcessorsForDrawing) {
  EXPECT_EQ(ChooseThreads(0), 1);
  EXPECT_EQ(ChooseThreads(2), 1);
  EXPECT_EQ(ChooseThreads(8), 4);
  EXPECT_EQ(ChooseThreads(64), 4);
}

}  // namespace
}  // namespace trocar::app
