// SPDX-License-Identifier: Apache-2.0
// What is left of a recording after a kill, a power cut, a full disk or an error of the disk.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "recorded_scene.h"
#include "trocar/host/safe_file.h"

namespace trocar::record {
namespace {

/// A disk: what was synced is safe; of the rest a power cut leaves any part, torn, with holes of old content.
struct FakeDisk {
  std::mutex mutex;  // of both, while a recorder writes
  std::vector<std::byte> synced, waiting;
  bool forgets_sync = false;               // control: says that it has synced, and has not
  int fails_append = -1, fails_sync = -1;  // the n-th call of each, from 0
  int appends = 0, syncs = 0, files = 0;
  std::uint64_t capacity = ~std::uint64_t{0};

  std::vector<std::byte> CutPower(std::mt19937_64& random) {
    const std::lock_guard lock(mutex);
    std::vector<std::byte> left = synced;
    std::vector<std::byte> tail(
        waiting.begin(),
        waiting.begin() + static_cast<std::ptrdiff_t>(waiting.empty() ? 0 : random() % (waiting.size() + 1)));
    for (std::size_t sector = 0; sector + 512 <= tail.size(); sector += 512) {
      if (random() % 3 == 0)
        std::fill_n(tail.begin() + static_cast<std::ptrdiff_t>(sector), 512, std::byte{});
    }
    left.insert(left.end(), tail.begin(), tail.end());
    return left;
  }
};

class FakeFile final : public Storage {
 public:
  explicit FakeFile(std::shared_ptr<FakeDisk> disk) : disk_(std::move(disk)) {
    const std::lock_guard lock(disk_->mutex);
    ++disk_->files;
    disk_->synced.clear();
    disk_->waiting.clear();
  }
  base::Status Append(std::span<const std::byte> bytes) override {
    FakeDisk& disk = *disk_;
    const std::lock_guard lock(disk.mutex);
    const bool is_full = disk.synced.size() + disk.waiting.size() + bytes.size() > disk.capacity;
    const bool fails = disk.appends++ == disk.fails_append;
    const std::size_t part = is_full || fails ? bytes.size() / 2 : bytes.size();
    disk.waiting.insert(disk.waiting.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(part));
    if (part < bytes.size()) return base::Error{base::ErrorCode::kFileUnwritable, "no space left"};
    return {};
  }
  base::Status Sync() override {
    FakeDisk& disk = *disk_;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));  // a disk takes its time
    const std::lock_guard lock(disk.mutex);
    if (disk.syncs++ == disk.fails_sync) {
      disk.waiting.clear();  // as some systems do: the pages are clean, and gone
      return base::Error{base::ErrorCode::kFileUnwritable, "the disk failed"};
    }
    if (disk.forgets_sync) return {};
    disk.synced.insert(disk.synced.end(), disk.waiting.begin(), disk.waiting.end());
    disk.waiting.clear();
    return {};
  }
  Space GetSpace() const override {
    const std::lock_guard lock(disk_->mutex);
    const std::uint64_t used = disk_->synced.size() + disk_->waiting.size();
    return {disk_->capacity - std::min(disk_->capacity, used), disk_->capacity};
  }

 private:
  std::shared_ptr<FakeDisk> disk_;
};

class Survival : public RecordedScene {
 protected:
  RecorderSettings On(const std::shared_ptr<FakeDisk>& disk) {
    RecorderSettings settings = Settings();
    settings.open = [disk](const std::filesystem::path&) {
      return base::Result<std::unique_ptr<Storage>>(std::make_unique<FakeFile>(disk));
    };
    return settings;
  }
  void Play(simulation::Simulation& simulation, Recorder& recorder, std::uint64_t from, std::uint64_t to) {
    for (std::uint64_t tick = from; tick < to; ++tick) {
      simulation.Step(InputOf(tick));
      recorder.Add(InputOf(tick), simulation);
    }
  }
  void ExpectKept(const Recording& recording, std::uint64_t kept) {
    ASSERT_GE(recording.inputs.size(), kept);
    for (std::size_t tick = 0; tick < recording.inputs.size(); ++tick)
      ASSERT_EQ(recording.inputs[tick], InputOf(tick)) << tick;
  }

  /// Records with a cut at a random moment. \return ticks that were said to be safe and are gone
  std::uint64_t CountLost(std::mt19937_64& random, bool forgets_sync) {
    auto disk = std::make_shared<FakeDisk>();
    auto simulation = Make();
    RecorderSettings settings = On(disk);
    settings.waits = false;  // as in the window: whatever there is is written
    auto recorder = Recorder::Start("x", Describe(), simulation, settings);
    EXPECT_TRUE(recorder.ok());
    disk->forgets_sync = forgets_sync;
    Play(simulation, **recorder, 0, 30 + random() % 200);
    std::uint64_t kept = (*recorder)->Status().kept;
    if (random() % 2 == 0) {
      // the worst moment: just after more was said to be safe
      for (const std::uint64_t before = kept; kept == before && kept < (*recorder)->Status().added;)
        kept = (*recorder)->Status().kept;
    }
    const auto left = ReadRecording(disk->CutPower(random), "cut");
    const std::uint64_t read = left.ok() ? left->inputs.size() : 0;
    if (left.ok()) ExpectKept(*left, 0);
    return read < kept ? kept - read : 0;
  }
};

TEST_F(Survival, APowerCutLosesNothingThatWasSaidToBeSafe) {
  std::mt19937_64 random(4);
  for (int cut = 0; cut < 20; ++cut) EXPECT_EQ(CountLost(random, false), 0u);
}

TEST_F(Survival, WithoutSyncItWouldLose) {
  std::mt19937_64 random(5);
  std::uint64_t lost = 0;
  for (int cut = 0; cut < 20; ++cut) lost += CountLost(random, true);
  EXPECT_GT(lost, 0u);
}

TEST_F(Survival, AfterAnErrorOfTheDiskAllGoesToANewFile) {
  for (int n = 1; n < 4; ++n) {
    for (const bool is_sync : {false, true}) {
      auto disk = std::make_shared<FakeDisk>();
      (is_sync ? disk->fails_sync : disk->fails_append) = n;
      auto simulation = Make();
      auto recorder = Recorder::Start("x.trocar", Describe(), simulation, On(disk));
      ASSERT_TRUE(recorder.ok());
      for (int part = 0; part < 4; ++part) {
        Play(simulation, **recorder, static_cast<std::uint64_t>(60 * part),
             static_cast<std::uint64_t>(60 * part + 60));
        std::this_thread::sleep_for(std::chrono::milliseconds(120));
      }
      const base::Status finished = (*recorder)->Finish(simulation);
      ASSERT_TRUE(finished.ok()) << finished.error().Text();
      EXPECT_EQ(disk->files, 2) << "a file that failed is not trusted again";
      EXPECT_EQ((*recorder)->Status().path, "x-2.trocar");
      const auto recording = ReadRecording(disk->synced, "second");
      ASSERT_TRUE(recording.ok());
      EXPECT_EQ(recording->damage, "");
      EXPECT_EQ(recording->inputs.size(), 240u);
      EXPECT_TRUE(recording->ending.has_value());
      ExpectKept(*recording, 240);
    }
  }
}

TEST_F(Survival, ANewFileTakesNobodysPlace) {
  Write("attempt-2.trocar", "somebody's recording");
  auto disk = std::make_shared<FakeDisk>();
  disk->fails_sync = 1;
  RecorderSettings settings = Settings();
  settings.open = [&, is_first = true](const std::filesystem::path& path) mutable {
    if (!std::exchange(is_first, false)) return MakeFile(path);
    return base::Result<std::unique_ptr<Storage>>(std::make_unique<FakeFile>(disk));
  };
  auto simulation = Make();
  auto recorder = Recorder::Start(File(), Describe(), simulation, settings);
  ASSERT_TRUE(recorder.ok());
  Play(simulation, **recorder, 0, 120);
  ASSERT_TRUE((*recorder)->Finish(simulation).ok());
  EXPECT_EQ((*recorder)->Status().path, folder_ / "attempt-3.trocar");
  EXPECT_EQ(*host::ReadFile(folder_ / "attempt-2.trocar"), "somebody's recording");
  const auto recording = ReadRecording(folder_ / "attempt-3.trocar");
  ASSERT_TRUE(recording.ok());
  EXPECT_TRUE(recording->ending.has_value());
  ExpectKept(*recording, 120);
}

TEST_F(Survival, OnAFullDiskItStopsSaysSoAndTheSimulationGoesOn) {
  auto disk = std::make_shared<FakeDisk>();
  disk->capacity = 200000;
  auto simulation = Make();
  auto recorder = Recorder::Start("x.trocar", Describe(), simulation, On(disk));
  ASSERT_TRUE(recorder.ok());
  bool was_low = false;
  std::uint64_t tick = 0;
  for (; tick < 20000 && !(*recorder)->Status().failure; ++tick) {
    simulation.Step(InputOf(tick));
    (*recorder)->Add(InputOf(tick), simulation);
    was_low = was_low || (*recorder)->Status().is_space_low;
  }
  ASSERT_TRUE((*recorder)->Status().failure.has_value());
  EXPECT_TRUE(was_low) << "a warning comes first";
  Play(simulation, **recorder, tick, tick + 10);
  EXPECT_EQ(simulation.GetSnapshot().tick, tick + 10);
  const base::Status finished = (*recorder)->Finish(simulation);
  ASSERT_FALSE(finished.ok());
  EXPECT_EQ(finished.error().code, base::ErrorCode::kFileUnwritable);
}

/// A program that records, killed at a random moment.
void KillOnce(const std::string& scene, const std::filesystem::path& file, std::mt19937_64& random,
              std::uint64_t& kept, std::uint64_t& read) {
  std::filesystem::remove(file);
  int out[2];
  ASSERT_EQ(::pipe2(out, O_CLOEXEC), 0);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  std::string victim = TROCAR_RECORD_VICTIM, scene_text = scene, file_text = file.string();
  char* arguments[] = {victim.data(), scene_text.data(), file_text.data(), nullptr};
  pid_t child = 0;
  ASSERT_EQ(::posix_spawn(&child, victim.c_str(), &actions, nullptr, arguments, environ), 0);
  posix_spawn_file_actions_destroy(&actions);
  ::close(out[1]);
  std::string said;
  char buffer[256];
  // it records once it has said its first number
  for (ssize_t got = 0; said.empty() && (got = ::read(out[0], buffer, sizeof buffer)) > 0;)
    said.append(buffer, static_cast<std::size_t>(got));
  std::this_thread::sleep_for(std::chrono::microseconds(random() % 300000));
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  for (ssize_t got = 0; (got = ::read(out[0], buffer, sizeof buffer)) > 0;)
    said.append(buffer, static_cast<std::size_t>(got));
  ::close(out[0]);
  ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself: " << said;
  // the last whole line
  said.resize(said.rfind('\n'));
  const std::size_t line = said.rfind('\n');
  kept = std::stoull(said.substr(line == std::string::npos ? 0 : line + 1));
  const auto recording = ReadRecording(file);
  ASSERT_TRUE(recording.ok()) << recording.error().Text();
  read = recording->inputs.size();
}

void KillMany(const std::string& scene, const std::filesystem::path& file, int times) {
  std::mt19937_64 random(6);
  std::uint64_t most_kept = 0;
  for (int i = 0; i < times; ++i) {
    std::uint64_t kept = 0, read = 0;
    ASSERT_NO_FATAL_FAILURE(KillOnce(scene, file, random, kept, read));
    ASSERT_GE(read, kept) << "said to be safe, and gone";
    most_kept = std::max(most_kept, kept);
  }
  EXPECT_GT(most_kept, 0u);
}

TEST_F(Survival, AKilledProgramLosesNothingThatWasSaidToBeSafe) {
  KillMany((folder_ / "scene.json").string(), File(), 25);
}

class SurvivalSlow : public Survival {};

TEST_F(SurvivalSlow, FiveHundredKills) {
  KillMany((folder_ / "scene.json").string(), File(), 500);
}

TEST_F(SurvivalSlow, TwoHundredPowerCuts) {
  std::mt19937_64 random(7);
  for (int cut = 0; cut < 200; ++cut) EXPECT_EQ(CountLost(random, false), 0u);
}

}  // namespace
}  // namespace trocar::record
