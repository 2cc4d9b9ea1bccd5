// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/player.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <thread>

#include "spectrum.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::sound {
namespace {

namespace fs = std::filesystem;

std::vector<float> ReadSamples(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  std::vector<float> samples(bytes.size() / sizeof(float));
  std::memcpy(samples.data(), bytes.data(), samples.size() * sizeof(float));
  return samples;
}

// Through the whole pipeline into a file, at the speed of a clock, as a card would take it.
TEST(Player, FileHoldsTheToneThatWasAskedForAndThenSilence) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.Path() / "samples";
  {
    Player player("audio/x-raw,format=F32LE,rate=48000,channels=1 ! filesink sync=true location=" +
                  file.string());
    player.SetSettings({1, false, true});
    player.SetState({.energy = EnergyTone::kCoagulation});
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    player.SetState({});
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    EXPECT_EQ(player.WhySilent(), "");
  }
  const std::vector<float> samples = ReadSamples(file);
  ASSERT_GT(samples.size(), std::size_t(kSampleRate));
  EXPECT_NEAR(FindPitch(std::span(samples).subspan(4800, 9600), 200, 1500), kCoagulationPitch,
              0.01 * kCoagulationPitch);
  EXPECT_EQ(CalcLoudest(std::span(samples).last(4800)), 0);
  EXPECT_LT(CalcLargestStep(samples), 0.02);
}

TEST(Player, NoCardIsSilenceWithAWordAndNoError) {
  if (!FindSoundOutput().empty()) GTEST_SKIP() << "this computer can sound";
  testing::internal::CaptureStderr();
  Player player;
  EXPECT_TRUE(player.WaitForEnd(20));
  EXPECT_EQ(player.WhySilent(), "no sound: this computer has no sound card");
  player.SetState({.energy = EnergyTone::kCut});
  player.Say(std::vector<float>(10, 0.F));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Player, AnOutputThatFailsIsSilenceWithAWord) {
  Player missing("no_such_element");
  EXPECT_TRUE(missing.WaitForEnd(20));
  EXPECT_NE(missing.WhySilent().find("no_such_element"), std::string::npos) << missing.WhySilent();
  Player refused("filesink location=/nowhere/at/all");
  EXPECT_TRUE(refused.WaitForEnd(20));
  EXPECT_EQ(refused.WhySilent().rfind("no sound: ", 0), 0u) << refused.WhySilent();
}

TEST(FindSoundOutput, SeesServersAndCardsUnderARoot) {
  const test::TemporaryFolder folder;
  const fs::path& root = folder.Path();
  ::unsetenv("PULSE_SERVER");
  ::setenv("XDG_RUNTIME_DIR", "/run/user/7", 1);
  EXPECT_EQ(FindSoundOutput(root), "");
  fs::create_directories(root / "proc/asound");
  std::ofstream(root / "proc/asound/cards") << "--- no soundcards ---\n";
  EXPECT_EQ(FindSoundOutput(root), "");
  std::ofstream(root / "proc/asound/cards")
      << " 0 [PCH            ]: HDA-Intel - HDA Intel PCH\n  at 0x1 irq 1\n";
  EXPECT_EQ(FindSoundOutput(root), "ALSA: HDA-Intel - HDA Intel PCH");
  fs::create_directories(root / "run/user/7");
  std::ofstream(root / "run/user/7/pipewire-0") << "";
  EXPECT_EQ(FindSoundOutput(root), "PulseAudio or PipeWire");
  ::setenv("PULSE_SERVER", "tcp:host", 1);
  EXPECT_EQ(FindSoundOutput(root), "PulseAudio at tcp:host");
  ::unsetenv("PULSE_SERVER");
}

}  // namespace
}  // namespace trocar::sound
