// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/window_settings.h"

#include <gtest/gtest.h>

#include "trocar/host/safe_file.h"
#include "trocar/presenter/home.h"
#include "trocar/presenter/tutorial.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

TEST(WindowSettings, ComeBackAsTheyWere) {
  const test::TemporaryFolder folder;
  const auto path = folder.Path() / "config" / "window.json";
  EXPECT_EQ(LoadWindowSettings(path).settings, WindowSettings{});
  EXPECT_FALSE(LoadWindowSettings(path).complaint);
  WindowSettings settings;
  settings.is_left_handed = settings.is_fulcrum_mirrored = settings.has_panel = true;
  settings.has_guides = false;
  settings.last_task = "peg_transfer";
  settings.last_part = "bed";
  settings.last_level = "hard";
  settings.has_depth_snap = false;
  settings.patient = "/patients/seed-7";
  settings.keys = {{"close-jaws", "m"}, {"in", "Page_Up"}};
  settings.buttons = {{"close", "right"}, {"open", "left"}};
  settings.last_seed = 7;
  settings.tutorial_step = 3;
  settings.person = "T-7F3K2Q";
  ASSERT_TRUE(SaveWindowSettings(path, settings).ok());
  const LoadedWindowSettings loaded = LoadWindowSettings(path);
  EXPECT_EQ(loaded.settings, settings);
  EXPECT_FALSE(loaded.complaint);
}

TEST(WindowSettings, ABrokenFileIsSaidAndTheUsualOnesHold) {
  const test::TemporaryFolder folder;
  const auto path = folder.Path() / "window.json";
  for (const char* text : {"", "{", "[]", R"({"format": "trocar-window-settings", "version": 2})",
                           R"({"format": "other", "version": 1})",
                           R"({"format": "trocar-window-settings", "version": 1, "guides": 3})",
                           R"({"format": "trocar-window-settings", "version": 1, "tutorial_step": 99})",
                           R"({"format": "trocar-window-settings", "version": 1, "last": {"level": "hard"}})",
                           R"({"format": "trocar-window-settings", "version": 1, "speed": 1})"}) {
    ASSERT_TRUE(host::WriteFile(path, text).ok());
    const LoadedWindowSettings loaded = LoadWindowSettings(path);
    EXPECT_EQ(loaded.settings, WindowSettings{}) << text;
    EXPECT_TRUE(loaded.complaint) << text;
  }
}

TEST(HomePage, LeadsAStrangerToTheTutorialAndOthersOn) {
  WindowSettings settings;
  HomePage page = MakeHomePage(settings, "Nobody in particular", {});
  EXPECT_TRUE(page.is_tutorial_suggested);
  EXPECT_EQ(page.tutorial, "Start");
  EXPECT_EQ(page.last, "") << "nothing to continue";
  settings.tutorial_step = 2;
  EXPECT_EQ(MakeHomePage(settings, "", {}).tutorial, "Go on: 3 of 10");
  settings.tutorial_step = kTutorialSteps;
  settings.last_task = "peg_transfer";
  settings.last_level = "hard";
  page = MakeHomePage(settings, "", {});
  EXPECT_FALSE(page.is_tutorial_suggested);
  EXPECT_EQ(page.tutorial, "Again");
  EXPECT_EQ(page.last, "peg transfer, hard");
}

}  // namespace
}  // namespace trocar::presenter
