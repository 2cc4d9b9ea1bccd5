// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cstring>

#include <random>

#include "recorded_scene.h"
#include "trocar/host/safe_file.h"
#include "trocar/record/outcome.h"
#include "trocar/simulation/engine_bits.h"
#include "trocar/simulation/saved_state.h"

namespace trocar::record {
namespace {

constexpr std::uint64_t kTicks = 500;

class ReplayTest : public RecordedScene {
 protected:
  void SetUp() override {
    RecordedScene::SetUp();
    Record(kTicks);
    auto simulation = Make();
    hashes_.push_back(simulation.Hash());
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      simulation.Step(InputOf(tick));
      hashes_.push_back(simulation.Hash());
    }
  }
  Recording ReadIt() {
    auto recording = ReadRecording(File());
    EXPECT_TRUE(recording.ok());
    return std::move(*recording);
  }
  Replay OpenIt(int threads = 1) {
    auto replay = Replay::Open(ReadIt(), threads);
    EXPECT_TRUE(replay.ok()) << replay.error().Text();
    return std::move(*replay);
  }
  std::vector<std::uint64_t> hashes_;  // after each tick
};

TEST_F(ReplayTest, IsTheSameToTheBitWithAnyNumberOfThreads) {
  for (const int threads : {1, 2, 4}) {
    Replay replay = OpenIt(threads);
    const auto verified = replay.Verify();
    ASSERT_TRUE(verified.ok()) << verified.error().Text();
    EXPECT_TRUE(verified->IsVerified());
    EXPECT_EQ(verified->ticks, kTicks);
    EXPECT_EQ(verified->hashes, kTicks / 30 + 1);
    EXPECT_EQ(replay.GetSimulation().Hash(), hash_);
  }
}

TEST_F(ReplayTest, OnlyTheEngineThatIsNotedReplaysIt) {
  Recording recording = ReadIt();
  EXPECT_EQ(recording.description.engine_bits, simulation::kEngineBits);
  EXPECT_TRUE(IsOfThisProgram(recording.description));
  ++recording.description.engine_bits;
  EXPECT_FALSE(IsOfThisProgram(recording.description));
  const auto replay = Replay::Open(std::move(recording), 1);
  ASSERT_FALSE(replay.ok());
  EXPECT_THAT(replay.error().message,
              testing::HasSubstr("engine " + std::to_string(simulation::kEngineBits)));
}

// Recordings of before name a fingerprint that covers less; they go on to fit, and only as what they are.
TEST_F(ReplayTest, AFingerprintOfBeforeFitsUnderItsOwnName) {
  using simulation::ModelFingerprintKind;
  const std::uint64_t first = OpenIt().GetSimulation().ModelFingerprint(ModelFingerprintKind::kFirst);
  Recording recording = ReadIt();
  EXPECT_EQ(recording.description.model_kind, ModelFingerprintKind::kEveryField);
  recording.description.model = first;
  EXPECT_FALSE(Replay::Open(std::move(recording), 1).ok());
  recording = ReadIt();
  recording.description.model = first;
  recording.description.model_kind = ModelFingerprintKind::kFirst;
  const auto replay = Replay::Open(std::move(recording), 1);
  ASSERT_TRUE(replay.ok()) << replay.error().Text();
}

// Keyframes of before hold the other fingerprint in their header, and nothing else that differs.
TEST_F(ReplayTest, AKeyframeIsComparedButForTheFingerprint) {
  const Recording recording = ReadIt();
  ASSERT_GT(recording.KeyframeTicks().size(), 0u);
  const std::vector<std::byte> state = *recording.ReadKeyframe(0);
  std::vector<std::byte> other = state;
  const std::uint64_t model = recording.description.model;
  std::size_t at = 0;
  while (at + sizeof(model) <= other.size() && std::memcmp(other.data() + at, &model, sizeof(model)) != 0)
    ++at;
  ASSERT_LT(at + sizeof(model), other.size());
  // a state of before is taken up, one of another model is not
  auto simulation = OpenIt().Branch(1);
  ASSERT_TRUE(simulation.ok());
  const std::uint64_t first = simulation->ModelFingerprint(simulation::ModelFingerprintKind::kFirst);
  std::memcpy(other.data() + at, &first, sizeof(first));
  EXPECT_TRUE(simulation->Restore(other).ok());
  EXPECT_TRUE(simulation::AreSameState(state, other));
  other[at] ^= std::byte{1};
  EXPECT_FALSE(simulation->Restore(other).ok());
  other = state;
  other[at - 1] ^= std::byte{1};
  EXPECT_FALSE(simulation::AreSameState(state, other)) << "the byte before it";
  other = state;
  other.back() ^= std::byte{1};
  EXPECT_FALSE(simulation::AreSameState(state, other));
  other.pop_back();
  EXPECT_FALSE(simulation::AreSameState(state, other));
}

TEST_F(ReplayTest, SeeksToAnyMoment) {
  Replay replay = OpenIt();
  std::mt19937_64 random(8);
  for (int i = 0; i < 60; ++i) {
    const std::uint64_t tick = random() % (kTicks + 1);
    const auto status = replay.Seek(tick);
    ASSERT_TRUE(status.ok()) << status.error().Text();
    ASSERT_EQ(replay.Tick(), tick);
    ASSERT_EQ(replay.GetSimulation().Hash(), hashes_[tick]) << "tick " << tick;
  }
  EXPECT_FALSE(replay.GetDivergence().has_value());
  ASSERT_TRUE(replay.Seek(kTicks + 1000).ok());
  EXPECT_TRUE(replay.IsAtEnd());
}

TEST_F(ReplayTest, AChangedInputDiverges) {
  Recording recording = ReadIt();
  // a hand that lags behind its input would forgive a single tick
  for (std::size_t tick = 200; tick < 215; ++tick) recording.inputs[tick].hands[1].spin += 0.3;
  auto replay = Replay::Open(std::move(recording), 1);
  ASSERT_TRUE(replay.ok());
  const auto verified = replay->Verify();
  ASSERT_TRUE(verified.ok());
  EXPECT_FALSE(verified->IsVerified());
  ASSERT_TRUE(verified->divergence.has_value());
  EXPECT_GT(verified->divergence->tick, 200u);
  EXPECT_LE(verified->divergence->tick, 240u) << "at the next hash";
}

TEST_F(ReplayTest, AChangedOutcomeDoesNotPass) {
  Recording recording = ReadIt();
  recording.ending->outcome = R"({"seconds":1.0})";
  auto replay = Replay::Open(std::move(recording), 1);
  ASSERT_TRUE(replay.ok());
  const auto verified = replay->Verify();
  ASSERT_TRUE(verified.ok());
  EXPECT_FALSE(verified->divergence.has_value());
  EXPECT_FALSE(verified->IsVerified());
}

TEST_F(ReplayTest, AnotherSceneIsRefused) {
  std::string text = SceneText();
  const std::size_t at = text.find("\"instruments\"");
  ASSERT_NE(at, std::string::npos);
  Recording recording = ReadIt();
  recording.description.model ^= 1;
  const auto replay = Replay::Open(std::move(recording), 1);
  ASSERT_FALSE(replay.ok());
  EXPECT_EQ(replay.error().code, base::ErrorCode::kRecordingInvalid);
  EXPECT_THAT(replay.error().message, testing::HasSubstr("changed"));
}

TEST_F(ReplayTest, WithoutAnEndingItReplaysWhatIsThere) {
  Recording recording = ReadIt();
  recording.ending.reset();
  auto replay = Replay::Open(std::move(recording), 1);
  ASSERT_TRUE(replay.ok());
  const auto verified = replay->Verify();
  ASSERT_TRUE(verified.ok());
  EXPECT_TRUE(verified->IsVerified());
}

TEST_F(ReplayTest, SomebodyElseTakesOver) {
  Replay replay = OpenIt();
  ASSERT_TRUE(replay.Seek(250).ok());
  auto branch = replay.Branch(2);
  ASSERT_TRUE(branch.ok()) << branch.error().Text();
  EXPECT_EQ(branch->Hash(), hashes_[250]);
  for (std::uint64_t tick = 250; tick < 300; ++tick) branch->Step(InputOf(tick));
  EXPECT_EQ(branch->Hash(), hashes_[300]);
  branch->Step(InputOf(0));
  EXPECT_NE(branch->Hash(), hashes_[301]);
  // the replay has stayed where it was
  EXPECT_EQ(replay.GetSimulation().Hash(), hashes_[250]);
}

TEST_F(ReplayTest, ASeekThatIsNoLongerWantedEndsAndGoesOnLater) {
  Replay replay = OpenIt();
  int asked = 0;
  ASSERT_TRUE(replay.Seek(59, [&] { return ++asked < 7; }).ok());
  EXPECT_EQ(replay.Tick(), 7u);
  ASSERT_TRUE(replay.Seek(59).ok());
  EXPECT_EQ(replay.GetSimulation().Hash(), hashes_[59]);
}

TEST_F(ReplayTest, StatesBesideTheRecordingOutliveIt) {
  ReplaySettings settings;
  settings.index = IndexPathOf(File());
  settings.visit_seconds = 0.1;  // 12 ticks
  {
    auto replay = Replay::Open(ReadIt(), settings);
    ASSERT_TRUE(replay.ok());
    ASSERT_TRUE(replay->Seek(55).ok());
  }
  auto replay = Replay::Open(ReadIt(), settings);
  ASSERT_TRUE(replay.ok());
  EXPECT_THAT(replay->KnownTicks(), testing::IsSupersetOf({0u, 12u, 24u, 36u, 48u, 60u}));
  int steps = 0;
  ASSERT_TRUE(replay->Seek(50, [&] { return ++steps < 1000; }).ok());
  EXPECT_EQ(steps, 2) << "from the state of tick 48";
  EXPECT_EQ(replay->GetSimulation().Hash(), hashes_[50]);
}

TEST_F(ReplayTest, FillsGapsUntilThereAreNone) {
  Replay replay = OpenIt();
  auto filler = replay.Another(0);
  ASSERT_TRUE(filler.ok()) << filler.error().Text();
  const double seconds = 20 * scene_->tick_seconds;
  int filled = 0;
  for (;;) {
    const auto done = filler->FillGap(250, seconds);
    ASSERT_TRUE(done.ok());
    if (!*done) break;
    if (filled++ == 0) {
      EXPECT_THAT(replay.KnownTicks(), testing::Contains(260u)) << "the gap after tick 250 first";
    }
  }
  EXPECT_GT(filled, 10);
  std::vector<std::uint64_t> ticks = replay.KnownTicks();
  ticks.push_back(kTicks);
  for (std::size_t i = 0; i + 1 < ticks.size(); ++i) EXPECT_LE(ticks[i + 1] - ticks[i], 20u);
  int steps = 0;
  ASSERT_TRUE(replay.Seek(333, [&] { return ++steps < 1000; }).ok());
  EXPECT_LE(steps, 20);
  EXPECT_EQ(replay.GetSimulation().Hash(), hashes_[333]);
}

TEST_F(ReplayTest, ADamagedStateBesideTheRecordingIsPassedBy) {
  ReplaySettings settings;
  settings.index = IndexPathOf(File());
  settings.visit_seconds = 0.1;
  {
    auto replay = Replay::Open(ReadIt(), settings);
    ASSERT_TRUE(replay.ok());
    ASSERT_TRUE(replay->Seek(kTicks).ok());
  }
  std::string bytes = *host::ReadFile(settings.index);
  std::mt19937_64 random(3);
  for (int round = 0; round < 30; ++round) {
    std::string damaged = bytes;
    for (int i = 0; i < 4; ++i) damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
    ASSERT_TRUE(host::WriteFile(settings.index, damaged).ok());
    auto replay = Replay::Open(ReadIt(), settings);
    ASSERT_TRUE(replay.ok());
    const std::uint64_t tick = random() % kTicks;
    ASSERT_TRUE(replay->Seek(tick).ok());
    ASSERT_EQ(replay->GetSimulation().Hash(), hashes_[tick]) << "round " << round;
    EXPECT_FALSE(replay->GetDivergence());
  }
}

TEST_F(ReplayTest, VerifyingUsesNoStateBesideTheRecording) {
  ReplaySettings settings;
  settings.index = IndexPathOf(File());
  auto replay = Replay::Open(ReadIt(), settings);
  ASSERT_TRUE(replay.ok());
  const auto verified = replay->Verify();
  ASSERT_TRUE(verified.ok());
  EXPECT_TRUE(verified->IsVerified());
  EXPECT_EQ(std::filesystem::file_size(settings.index), 32u) << "a header";
}

}  // namespace
}  // namespace trocar::record
