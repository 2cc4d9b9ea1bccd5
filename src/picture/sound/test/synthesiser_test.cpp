// SPDX-License-Identifier: Apache-2.0
#include "trocar/sound/synthesiser.h"

#include <gtest/gtest.h>

#include <random>

#include "spectrum.h"

namespace trocar::sound {
namespace {

constexpr std::size_t kTenth = kSampleRate / 10;

std::vector<float> Render(Synthesiser& synthesiser, std::size_t count) {
  std::vector<float> samples(count);
  synthesiser.Render(samples);
  return samples;
}

Synthesiser MakeLoud(const SoundState& state) {
  Synthesiser synthesiser;
  synthesiser.SetSettings({1, false, true});
  synthesiser.SetState(state);
  return synthesiser;
}

TEST(Synthesiser, CutAndCoagulationHaveTheirOwnPitch) {
  for (const auto& [tone, pitch] :
       {std::pair{EnergyTone::kCut, kCutPitch}, {EnergyTone::kCoagulation, kCoagulationPitch}}) {
    Synthesiser synthesiser = MakeLoud({.energy = tone});
    Render(synthesiser, kTenth);  // past the ramps
    const std::vector<float> samples = Render(synthesiser, 2 * kTenth);
    EXPECT_NEAR(FindPitch(samples, 200, 1500), pitch, 0.01 * pitch);
  }
}

TEST(Synthesiser, PulseComesWithTheHeartAndSinksWithTheSaturation) {
  for (const double saturation : {0.98, 0.90, 0.80}) {
    Synthesiser synthesiser = MakeLoud({.has_pulse = true, .signs = {120, saturation}});
    const std::vector<float> samples = Render(synthesiser, 10 * kSampleRate);
    // beginnings of beeps
    std::vector<std::size_t> beats;
    std::size_t quiet = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (std::fabs(samples[i]) < 1e-4F) {
        ++quiet;
        continue;
      }
      if (quiet > kTenth) beats.push_back(i);
      quiet = 0;
    }
    ASSERT_NEAR(static_cast<double>(beats.size()), 20, 1);
    const double seconds = static_cast<double>(beats.back() - beats.front()) / kSampleRate;
    EXPECT_NEAR(60 * static_cast<double>(beats.size() - 1) / seconds, 120, 0.5);
    const double pitch = CalcPulsePitch(saturation);
    EXPECT_NEAR(FindPitch(std::span(samples).subspan(beats[3], 4000), 300, 1500), pitch, 0.01 * pitch);
  }
}

TEST(Synthesiser, EachClipClicksOnceAndThoseOfBeforeDoNot) {
  Synthesiser synthesiser = MakeLoud({.clicks = 5});
  EXPECT_EQ(CalcLoudest(Render(synthesiser, kTenth)), 0);
  synthesiser.SetState({.clicks = 7});
  const std::vector<float> samples = Render(synthesiser, 3 * kTenth);
  const auto part = [&](double from, double to) {
    return CalcLoudest(std::span(samples).subspan(static_cast<std::size_t>(from * kSampleRate),
                                                  static_cast<std::size_t>((to - from) * kSampleRate)));
  };
  EXPECT_GT(part(0, 0.01), 0.1);
  EXPECT_LT(part(0.04, 0.049), 0.001);
  EXPECT_GT(part(0.05, 0.06), 0.1);
  EXPECT_LT(part(0.12, 0.3), 1e-6);
  EXPECT_EQ(CalcLoudest(Render(synthesiser, kTenth)), 0);
}

TEST(Synthesiser, TonesBeginChangeAndEndWithoutAClick) {
  Synthesiser synthesiser = MakeLoud({});
  Render(synthesiser, kTenth);
  std::vector<float> all;
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    synthesiser.SetState({.energy = static_cast<EnergyTone>(random() % 3),
                          .has_pulse = random() % 2 == 0,
                          .signs = {180, 0.9}});
    synthesiser.SetSettings({0.2 * static_cast<double>(random() % 6), random() % 4 == 0, true});
    const std::vector<float> part = Render(synthesiser, 50 + random() % 3000);
    all.insert(all.end(), part.begin(), part.end());
  }
  // the steepest that both tones can be together: 2 pi f / rate times their levels, and the ramps' own slope
  const double steepest =
      2 * std::numbers::pi * (0.20 * kCutPitch * 1.4 / 1.2 + 0.20 * 880) / kSampleRate + 0.002;
  EXPECT_GT(CalcLargestStep(all), 0.01);
  EXPECT_LT(CalcLargestStep(all), steepest);
}

TEST(Synthesiser, EverythingTogetherStaysWithinItsBounds) {
  Synthesiser synthesiser = MakeLoud({.energy = EnergyTone::kCut, .has_pulse = true, .signs = {200, 1}});
  std::vector<float> shouting(kSampleRate);
  for (std::size_t i = 0; i < shouting.size(); ++i)
    shouting[i] = i % 80 < 40 ? 5.0F : -5.0F;  // beyond what may come
  synthesiser.Say(shouting);
  double loudest = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    synthesiser.SetState({.energy = EnergyTone::kCut, .clicks = 3 * i, .has_pulse = true, .signs = {200, 1}});
    loudest = std::max(loudest, CalcLoudest(Render(synthesiser, kTenth / 10)));
  }
  EXPECT_GT(loudest, 0.5);
  EXPECT_LE(loudest, static_cast<double>(Synthesiser::kLoudest));
}

TEST(Synthesiser, MutedIsNothingAndVolumeScales) {
  Synthesiser synthesiser = MakeLoud({.energy = EnergyTone::kCut});
  Render(synthesiser, kTenth);
  const double full = CalcLoudest(Render(synthesiser, kTenth));
  synthesiser.SetSettings({0.25, false, true});
  Render(synthesiser, kTenth);
  EXPECT_NEAR(CalcLoudest(Render(synthesiser, kTenth)), 0.25 * full, 0.001);
  synthesiser.SetSettings({0.25, true, true});
  Render(synthesiser, kTenth);
  EXPECT_EQ(CalcLoudest(Render(synthesiser, kTenth)), 0);
}

TEST(Synthesiser, SpeaksTheSamplesOnce) {
  Synthesiser synthesiser = MakeLoud({});
  Render(synthesiser, kTenth);
  synthesiser.Say(std::vector<float>(1000, 0.5F));
  EXPECT_TRUE(synthesiser.IsSpeaking());
  EXPECT_NEAR(CalcLoudest(Render(synthesiser, 1000)), 0.15, 1e-6);
  EXPECT_FALSE(synthesiser.IsSpeaking());
  EXPECT_EQ(CalcLoudest(Render(synthesiser, 1000)), 0);
}

}  // namespace
}  // namespace trocar::sound
