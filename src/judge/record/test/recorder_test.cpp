// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "recorded_scene.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/version.h"
#include "trocar/record/replay.h"

namespace trocar::record {
namespace {

class RecorderTest : public RecordedScene {};

TEST_F(RecorderTest, KeepsEveryInputHashKeyframeAndTheEnding) {
  Record(400);
  auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok()) << recording.error().Text();
  EXPECT_EQ(recording->damage, "");
  ASSERT_EQ(recording->inputs.size(), 400u);
  for (std::uint64_t tick = 0; tick < 400; ++tick) ASSERT_EQ(recording->inputs[tick], InputOf(tick)) << tick;
  EXPECT_EQ(recording->hashes.size(), 400u / 30);
  EXPECT_THAT(recording->KeyframeTicks(), testing::ElementsAre(60, 120, 180, 240, 300, 360));
  ASSERT_TRUE(recording->ending.has_value());
  EXPECT_EQ(recording->ending->ticks, 400u);
  EXPECT_EQ(recording->ending->hash, hash_);
  EXPECT_THAT(recording->ending->outcome, testing::HasSubstr("\"seconds\""));
  ASSERT_EQ(recording->marks.size(), 1u);
  EXPECT_EQ(recording->marks[0].text, "the end");
  EXPECT_EQ(recording->marks[0].tick, 400u);
  const Description& d = recording->description;
  EXPECT_EQ(d.player, "a test");
  EXPECT_EQ(d.program, host::VersionText());
  EXPECT_EQ(d.first_tick, 0u);
  EXPECT_EQ(d.tick_seconds, scene_->tick_seconds);
  EXPECT_FALSE(d.compiler.empty());
  EXPECT_FALSE(d.started.empty());
}

TEST_F(RecorderTest, AKeyframeIsTheSavedState) {
  Record(400);
  auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  auto simulation = Make();
  std::vector<std::byte> state;
  std::size_t frame = 0;
  for (std::uint64_t tick = 0; tick < 400; ++tick) {
    simulation.Step(InputOf(tick));
    if (frame < recording->KeyframeTicks().size() && recording->KeyframeTicks()[frame] == tick + 1) {
      const auto read = recording->ReadKeyframe(frame++);
      ASSERT_TRUE(read.ok()) << read.error().Text();
      simulation.Save(state);
      EXPECT_EQ(*read, state) << "tick " << tick + 1;
    }
  }
  EXPECT_EQ(frame, 6u);
}

TEST_F(RecorderTest, NotesEvents) {
  auto simulation = Make();
  auto recorder = Recorder::Start(File(), Describe(), simulation, Settings());
  ASSERT_TRUE(recorder.ok());
  std::vector<std::string> seen;
  std::uint64_t count = 0;
  for (int tick = 0; tick < 150; ++tick) {
    const scene::Input input = scene::CalcScriptInput(*scene_, simulation.GetSnapshot().time);
    simulation.Step(input);
    (*recorder)->Add(input, simulation);
    const auto& now = simulation.GetSnapshot();
    for (; count < now.event_count; ++count)
      seen.emplace_back(surgery::FactName(now.events[count % simulation::kEventRing].kind));
  }
  ASSERT_TRUE((*recorder)->Finish(simulation).ok());
  EXPECT_FALSE(seen.empty());
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  std::vector<std::string> noted;
  for (const EventMark& event : recording->events) noted.push_back(event.kind);
  EXPECT_EQ(noted, seen);
}

TEST_F(RecorderTest, GoesOnFromTheMiddle) {
  auto simulation = Make();
  for (std::uint64_t tick = 0; tick < 100; ++tick) simulation.Step(InputOf(tick));
  std::vector<std::byte> start;
  simulation.Save(start);
  auto recorder = Recorder::Start(File(), Describe(), simulation, Settings());
  ASSERT_TRUE(recorder.ok());
  (*recorder)->Mark("from here");
  for (std::uint64_t tick = 100; tick < 200; ++tick) {
    simulation.Step(InputOf(tick));
    (*recorder)->Add(InputOf(tick), simulation);
  }
  ASSERT_TRUE((*recorder)->Finish(simulation).ok());
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->FirstTick(), 100u);
  EXPECT_EQ(recording->LastTick(), 200u);
  ASSERT_FALSE(recording->KeyframeTicks().empty());
  EXPECT_EQ(recording->KeyframeTicks()[0], 100u);
  EXPECT_EQ(*recording->ReadKeyframe(0), start);
  ASSERT_EQ(recording->marks.size(), 1u);
  EXPECT_EQ(recording->marks[0].tick, 100u);
}

// Fault R10: what was recorded is counted by ticks; that the clock jumped, when and by how much, stands in the recording.
TEST_F(RecorderTest, MarksAClockThatJumps) {
  std::atomic<double> moved{0};
  RecorderSettings settings = Settings();
  settings.clocks = [&moved, start = ReadClocks().steady] {
    ClockReading now = ReadClocks();
    now.wall = 1.8e9 + (now.steady - start) + moved.load();
    return now;
  };
  auto simulation = Make();
  auto recorder = Recorder::Start(File(), Describe(), simulation, settings);
  ASSERT_TRUE(recorder.ok());
  for (std::uint64_t tick = 0; tick < 60; ++tick) {
    simulation.Step(InputOf(tick));
    (*recorder)->Add(InputOf(tick), simulation);
    if (tick == 29) moved.store(-3600);
  }
  ASSERT_TRUE((*recorder)->Finish(simulation).ok());
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->inputs.size(), 60u) << "nothing is lost";
  ASSERT_EQ(recording->marks.size(), 1u);
  EXPECT_THAT(recording->marks[0].text, testing::HasSubstr("clock jumped by -3600.0 s"));
  EXPECT_THAT(recording->description.started, testing::StartsWith("2027-01-1"));
}

TEST_F(RecorderTest, SaysFromWhichRecordingItBranched) {
  auto simulation = Make();
  Description description = Describe();
  description.branched_from = "first.trocar";
  description.branched_id = 0x1234567890abcdef;
  description.branched_tick = 77;
  auto recorder = Recorder::Start(File(), description, simulation, Settings());
  ASSERT_TRUE(recorder.ok());
  ASSERT_TRUE((*recorder)->Finish(simulation).ok());
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->description.branched_from, "first.trocar");
  EXPECT_EQ(recording->description.branched_id, 0x1234567890abcdefu);
  EXPECT_EQ(recording->description.branched_tick, 77u);
  EXPECT_NE(recording->file_id, 0u);
}

TEST_F(RecorderTest, KeepsAnIndexWhereItIsWanted) {
  RecorderSettings settings = Settings();
  settings.index_seconds = 0.1;  // 12 ticks; keyframes every 60
  Record(200, settings);
  auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  EXPECT_THAT(recording->KeyframeTicks(), testing::ElementsAre(60, 120, 180));
  ReplaySettings replay_settings;
  replay_settings.index = IndexPathOf(File());
  auto replay = Replay::Open(std::move(*recording), replay_settings);
  ASSERT_TRUE(replay.ok());
  EXPECT_THAT(replay->KnownTicks(), testing::ElementsAre(0, 12, 24, 36, 48, 60, 72, 84, 96, 108, 120, 132,
                                                         144, 156, 168, 180, 192));
  ASSERT_TRUE(replay->Seek(200).ok());
  EXPECT_EQ(replay->GetSimulation().Hash(), hash_);
  std::filesystem::remove(IndexPathOf(File()));
  std::filesystem::remove(File());
  Record(200);
  EXPECT_FALSE(std::filesystem::exists(IndexPathOf(File()))) << "nobody wants one";
}

TEST_F(RecorderTest, TrimsIndexesTheOldestFirst) {
  const auto now = std::filesystem::file_time_type::clock::now();
  for (int i = 0; i < 4; ++i) {
    const std::string name = "a" + std::to_string(i) + ".trocar";
    Write(name.c_str(), "recording");
    Write((name + ".index").c_str(), std::string(1000, 'x'));
    std::filesystem::last_write_time(folder_ / (name + ".index"), now - std::chrono::minutes(i));
  }
  TrimIndexes(folder_, 2500);
  for (int i = 0; i < 4; ++i) {
    const std::string name = "a" + std::to_string(i) + ".trocar";
    EXPECT_TRUE(std::filesystem::exists(folder_ / name));
    EXPECT_EQ(std::filesystem::exists(folder_ / (name + ".index")), i < 2) << i;
  }
}

TEST_F(RecorderTest, NeverReplacesAFile) {
  Write("attempt.trocar", "somebody's");
  auto simulation = Make();
  const auto recorder = Recorder::Start(File(), Describe(), simulation);
  ASSERT_FALSE(recorder.ok());
  EXPECT_EQ(recorder.error().code, base::ErrorCode::kFileUnwritable);
  EXPECT_THAT(recorder.error().message, testing::HasSubstr("name a new one"));
}

TEST_F(RecorderTest, TellsWhatIsSafe) {
  auto simulation = Make();
  auto recorder = Recorder::Start(File(), Describe(), simulation, Settings());
  ASSERT_TRUE(recorder.ok());
  for (std::uint64_t tick = 0; tick < 60; ++tick) {
    simulation.Step(InputOf(tick));
    (*recorder)->Add(InputOf(tick), simulation);
  }
  for (int i = 0; i < 1000 && (*recorder)->Status().kept < 60; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const RecorderStatus status = (*recorder)->Status();
  EXPECT_EQ(status.added, 60u);
  EXPECT_EQ(status.kept, 60u);
  EXPECT_GT(status.bytes, 100u);
  EXPECT_FALSE(status.failure.has_value());
  EXPECT_EQ(status.path, File());
  // it is there without Finish
  const auto recording = ReadRecording(File());
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->inputs.size(), 60u);
  EXPECT_FALSE(recording->ending.has_value());
}

// A slow computer wrote two ticks a chunk, and a third of the recording was chunks' headers.
TEST_F(RecorderTest, ChunksAreWholeAtAnyPaceWhereNobodyWaits) {
  const auto record = [&](const std::filesystem::path& file, std::chrono::milliseconds pause) {
    auto simulation = Make();
    auto recorder = Recorder::Start(file, Describe(), simulation, Settings());
    ASSERT_TRUE(recorder.ok()) << recorder.error().Text();
    for (std::uint64_t tick = 0; tick < 50; ++tick) {
      simulation.Step(InputOf(tick));
      (*recorder)->Add(InputOf(tick), simulation);
      std::this_thread::sleep_for(pause);
    }
    ASSERT_TRUE((*recorder)->Finish(simulation).ok());
  };
  const auto quick = folder_ / "quick.trocar", slow = folder_ / "slow.trocar";
  record(quick, std::chrono::milliseconds(0));
  record(slow, std::chrono::milliseconds(20));
  EXPECT_EQ(std::filesystem::file_size(slow), std::filesystem::file_size(quick));
  const auto recording = ReadRecording(slow);
  ASSERT_TRUE(recording.ok());
  EXPECT_EQ(recording->inputs.size(), 50u);
}

TEST(RecordingFolder, IsWhereThePersonKeepsData) {
  const auto with = [](const char* own, const char* shared) {
    ::setenv("TROCAR_DATA_HOME", own, 1);
    ::setenv("XDG_DATA_HOME", shared, 1);
    const auto folder = FindRecordingFolder();
    ::unsetenv("TROCAR_DATA_HOME");
    ::unsetenv("XDG_DATA_HOME");
    return folder;
  };
  EXPECT_EQ(with("/own", "/shared"), "/own/recordings");
  EXPECT_EQ(with("", "/shared"), "/shared/trocar/recordings");
  EXPECT_EQ(with("", ""), std::filesystem::path(std::getenv("HOME")) / ".local/share/trocar/recordings");
}

}  // namespace
}  // namespace trocar::record
