// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/window_sound.h"

#include <gtest/gtest.h>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

TEST(SoundSettings, ComeBackAsTheyWere) {
  const test::TemporaryFolder folder;
  const auto file = folder.Path() / "config" / "sound.json";
  EXPECT_EQ(LoadSoundSettings(file).settings, sound::SoundSettings{});
  EXPECT_FALSE(LoadSoundSettings(file).complaint);
  const sound::SoundSettings settings{0.25, true, false};
  ASSERT_TRUE(SaveSoundSettings(file, settings).ok());
  EXPECT_EQ(LoadSoundSettings(file).settings, settings);
}

TEST(SoundSettings, ABrokenFileIsSaidAndKept) {
  const test::TemporaryFolder folder;
  const auto file = folder.Path() / "sound.json";
  for (const char* text :
       {"{", R"({"format": "other", "version": 1})", R"({"format": "trocar-sound-settings", "version": 2})",
        R"({"format": "trocar-sound-settings", "version": 1, "volume": 1.5})",
        R"({"format": "trocar-sound-settings", "version": 1, "loud": true})"}) {
    ASSERT_TRUE(host::WriteFile(file, text).ok());
    EXPECT_TRUE(LoadSoundSettings(file).complaint) << text;
    WindowSound sound(file, "fakesink");
    EXPECT_EQ(sound.Settings(), sound::SoundSettings{}) << text;
    sound.ToggleMute();
    EXPECT_TRUE(LoadSoundSettings(file).complaint) << "overwritten: " << text;
  }
}

TEST(WindowSound, SettingsActInStepsAndLast) {
  const test::TemporaryFolder folder;
  const auto file = folder.Path() / "sound.json";
  {
    WindowSound sound(file, "fakesink sync=true");
    EXPECT_EQ(sound.Describe(), "Sound 50 %");
    sound.ChangeVolume(1);
    EXPECT_EQ(sound.Describe(), "Sound 60 %");
    sound.ToggleMute();
    EXPECT_EQ(sound.Describe(), "Sound off");
    sound.ChangeVolume(-1);
    EXPECT_EQ(sound.Describe(), "Sound 50 %") << "whoever changes the volume wants to hear";
    for (int i = 0; i < 20; ++i) sound.ChangeVolume(1);
    EXPECT_EQ(sound.Describe(), "Sound 100 %");
    sound.ToggleSpeech();
    EXPECT_EQ(sound.Describe(), "Sound 100 %, no speech");
  }
  const WindowSound later(file, "fakesink sync=true");
  EXPECT_EQ(later.Settings(), (sound::SoundSettings{1, false, false}));
}

}  // namespace
}  // namespace trocar::presenter
