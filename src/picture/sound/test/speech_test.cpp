// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/speech.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <numbers>

#include "spectrum.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::sound {
namespace {

namespace fs = std::filesystem;

void Put(std::vector<unsigned char>& bytes, std::uint32_t number, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<unsigned char>(number >> 8 * i));
}

/// A tenth of a second of 500 Hz, as espeak-ng writes it into a pipe: with lengths that say nothing.
std::vector<unsigned char> MakeWave(std::uint32_t rate, std::uint32_t length = 0x7ffff000) {
  std::vector<unsigned char> bytes = {'R', 'I', 'F', 'F'};
  Put(bytes, length, 4);
  for (const char c : std::string_view("WAVEfmt ")) bytes.push_back(static_cast<unsigned char>(c));
  Put(bytes, 16, 4);
  Put(bytes, 1, 2);
  Put(bytes, 1, 2);
  Put(bytes, rate, 4);
  Put(bytes, 2 * rate, 4);
  Put(bytes, 2, 2);
  Put(bytes, 16, 2);
  for (const char c : std::string_view("data")) bytes.push_back(static_cast<unsigned char>(c));
  Put(bytes, length, 4);
  for (std::uint32_t i = 0; i < rate / 10; ++i)
    Put(bytes,
        static_cast<std::uint32_t>(std::lround(16000 * std::sin(2 * std::numbers::pi * 500 * i / rate))), 2);
  return bytes;
}

TEST(Speech, WaveKeepsPitchAndLengthAtAnotherRate) {
  for (const std::uint32_t rate : {16000u, 22050u, 48000u}) {
    const auto samples = ReadWave(MakeWave(rate));
    ASSERT_TRUE(samples);
    EXPECT_NEAR(static_cast<double>(samples->size()), 0.1 * kSampleRate, 0.003 * kSampleRate);
    EXPECT_NEAR(FindPitch(*samples, 300, 900), 500, 5);
    EXPECT_NEAR(CalcLoudest(*samples), 16000.0 / 32768, 0.01);
  }
}

TEST(Speech, RejectsEveryTruncatedHeaderAndOtherKinds) {
  const std::vector<unsigned char> whole = MakeWave(22050);
  for (std::size_t length = 0; length < 48; ++length)
    EXPECT_FALSE(ReadWave(std::span(whole).first(length))) << length;
  for (const std::size_t at : {0, 8, 20, 22, 34}) {  // tags, kind, channels, bits
    std::vector<unsigned char> changed = whole;
    changed[at] ^= 0x40;
    EXPECT_FALSE(ReadWave(changed)) << at;
  }
}

/// A program that keeps its input and its options beside itself and answers with a wave.
fs::path MakeProgram(const fs::path& folder) {
  const std::vector<unsigned char> wave = MakeWave(16000);
  std::ofstream(folder / "wave", std::ios::binary)
      .write(reinterpret_cast<const char*>(wave.data()), static_cast<std::streamsize>(wave.size()));
  const fs::path program = folder / "speaks";
  std::ofstream(program) << "#!/bin/sh\ncd '" << folder.string()
                         << "'\ncat >text\necho \"$@\" >options\ncat wave\n";
  fs::permissions(program, fs::perms::owner_all);
  return program;
}

TEST(Speech, ProgramGetsTheTextAndTheLanguageAndNothingElse) {
  const test::TemporaryFolder folder;
  const fs::path program = MakeProgram(folder.Path());
  const std::string text = "--help; $(reboot) pinza";
  const auto samples = CalcSpeech(program, text, "es");
  ASSERT_TRUE(samples);
  EXPECT_NEAR(FindPitch(*samples, 300, 900), 500, 5);
  std::string read, options;
  std::getline(std::ifstream(folder.Path() / "text") >> std::ws, read);
  std::getline(std::ifstream(folder.Path() / "options"), options);
  EXPECT_EQ(read, text);
  EXPECT_EQ(options, "--stdin --stdout -s 165 -v es");
}

TEST(Speech, AMissingOrFailingProgramSaysNothing) {
  EXPECT_FALSE(CalcSpeech("", "words", "en"));
  EXPECT_FALSE(CalcSpeech("/nowhere/espeak-ng", "words", "en"));
  EXPECT_FALSE(CalcSpeech("/bin/false", "words", "en"));
  EXPECT_FALSE(CalcSpeech("/bin/true", "words", "en"));
}

TEST(Speech, EspeakSpeaksWhereItIsInstalled) {
  const std::string program = FindSpeechProgram();
  if (program.empty()) GTEST_SKIP() << "espeak-ng is not installed";
  const auto english = CalcSpeech(program, "Close the clip.", "en"),
             spanish = CalcSpeech(program, "Cierre el clip.", "es");
  ASSERT_TRUE(english && spanish);
  EXPECT_GT(english->size(), std::size_t(0.4 * kSampleRate));
  EXPECT_GT(CalcLoudest(*english), 0.05);
  EXPECT_NE(*english, *spanish);
}

TEST(Speaker, PlaysTheNewestTextAndEndsWithOneStillWaiting) {
  std::mutex mutex;
  std::condition_variable changed;
  int played = 0;
  const test::TemporaryFolder folder;
  const fs::path program = MakeProgram(folder.Path());
  {
    Speaker speaker(program, [&](const std::vector<float>& samples) {
      const std::lock_guard lock(mutex);
      played += samples.empty() ? 0 : 1;
      changed.notify_all();
    });
    speaker.Say("one", "en");
    std::unique_lock lock(mutex);
    ASSERT_TRUE(changed.wait_for(lock, std::chrono::seconds(20), [&] { return played > 0; }));
    lock.unlock();
    speaker.Say("two", "en");
  }
  EXPECT_GE(played, 1);
}

}  // namespace
}  // namespace trocar::sound
