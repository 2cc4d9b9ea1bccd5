// SPDX-License-Identifier: Apache-2.0
#include "state_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <thread>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::record {
namespace {

std::vector<std::byte> StateOf(std::uint64_t tick) {
  std::mt19937_64 random(tick);
  std::vector<std::byte> state(4096);
  // most of it is the same in every state
  for (std::size_t i = 0; i < state.size(); ++i)
    state[i] = static_cast<std::byte>(i % 16 == 0 ? random() : (i * i) >> 3);
  return state;
}

class StateIndexTest : public testing::Test {
 protected:
  StateIndexSettings Settings() const {
    StateIndexSettings settings;
    settings.path = folder_.Path() / "a.trocar.index";
    settings.recording = 5, settings.model = 6;
    return settings;
  }
  test::TemporaryFolder folder_;
};

TEST_F(StateIndexTest, GivesBackWhatItTook) {
  for (const bool is_in_memory : {true, false}) {
    StateIndexSettings settings = Settings();
    if (is_in_memory) settings.path.clear();
    StateIndex index(settings);
    EXPECT_EQ(index.IsOnDisk(), !is_in_memory);
    EXPECT_FALSE(index.FindBefore(1000));
    for (const std::uint64_t tick : {30, 10, 20}) index.Add(tick, StateOf(tick));
    EXPECT_THAT(index.Ticks(), testing::ElementsAre(10, 20, 30));
    for (const std::uint64_t tick : {10, 20, 30}) EXPECT_EQ(index.Read(tick), StateOf(tick));
    EXPECT_TRUE(index.Read(15).empty());
    EXPECT_TRUE(index.Has(20));
    EXPECT_FALSE(index.Has(21));
    EXPECT_FALSE(index.FindBefore(9));
    EXPECT_EQ(index.FindBefore(10), 10u);
    EXPECT_EQ(index.FindBefore(29), 20u);
    EXPECT_LT(index.Bytes(), 3 * 4096u);
  }
}

TEST_F(StateIndexTest, IsThereTheNextTimeButNotForAnotherRecordingOrModel) {
  {
    StateIndex index(Settings());
    for (const std::uint64_t tick : {10, 20, 30}) index.Add(tick, StateOf(tick));
  }
  {
    StateIndex index(Settings());
    EXPECT_EQ(index.Read(20), StateOf(20));
    index.Add(40, StateOf(40));
    EXPECT_EQ(index.Read(40), StateOf(40));
  }
  EXPECT_EQ(StateIndex(Settings()).Ticks().size(), 4u);
  StateIndexSettings other = Settings();
  other.model = 7;
  EXPECT_TRUE(StateIndex(other).Ticks().empty());
  EXPECT_TRUE(StateIndex(Settings()).Ticks().empty()) << "it was replaced";
}

TEST_F(StateIndexTest, ASecondOneReadsAndKeepsItsOwnInMemory) {
  StateIndex index(Settings());
  index.Add(10, StateOf(10));
  StateIndex second(Settings());
  EXPECT_FALSE(second.IsOnDisk());
  EXPECT_EQ(second.Read(10), StateOf(10));
  second.Add(20, StateOf(20));
  EXPECT_EQ(second.Read(20), StateOf(20));
  EXPECT_FALSE(index.Has(20));
}

TEST_F(StateIndexTest, EveryCutIsReadUpToThere) {
  {
    StateIndex index(Settings());
    for (const std::uint64_t tick : {10, 20, 30}) index.Add(tick, StateOf(tick));
  }
  const std::string whole = *host::ReadFile(Settings().path);
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    ASSERT_TRUE(host::WriteFile(Settings().path, whole.substr(0, size)).ok());
    StateIndex index(Settings());
    for (const std::uint64_t tick : index.Ticks()) EXPECT_EQ(index.Read(tick), StateOf(tick)) << size;
    index.Add(50, StateOf(50));
    EXPECT_EQ(index.Read(50), StateOf(50));
  }
}

TEST_F(StateIndexTest, AFlippedBitLosesAStateButInventsNone) {
  {
    StateIndex index(Settings());
    for (const std::uint64_t tick : {10, 20, 30}) index.Add(tick, StateOf(tick));
  }
  const std::string whole = *host::ReadFile(Settings().path);
  std::mt19937_64 random(1);
  for (int round = 0; round < 2000; ++round) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] ^= static_cast<char>(1 << random() % 8);
    ASSERT_TRUE(host::WriteFile(Settings().path, damaged).ok());
    StateIndex index(Settings());
    for (const std::uint64_t tick : index.Ticks()) {
      const auto state = index.Read(tick);
      if (state.empty()) continue;
      ASSERT_EQ(state, StateOf(tick)) << "round " << round;
    }
  }
}

TEST_F(StateIndexTest, StaysWithinItsBytes) {
  StateIndexSettings settings = Settings();
  settings.most_bytes = 8000;
  for (const bool is_in_memory : {true, false}) {
    if (is_in_memory)
      settings.path.clear();
    else
      settings.path = Settings().path;
    StateIndex index(settings);
    for (std::uint64_t tick = 0; tick < 100; ++tick) index.Add(tick, StateOf(tick));
    EXPECT_LT(index.Bytes(), 8000u + 4096u);
    EXPECT_GE(index.Ticks().size(), 5u);
    for (const std::uint64_t tick : index.Ticks()) EXPECT_EQ(index.Read(tick), StateOf(tick));
    // memory keeps states of all times, a file the first ones
    EXPECT_EQ(index.Ticks().back() > 90, is_in_memory);
  }
}

TEST_F(StateIndexTest, AFolderThatIsNoneMeansMemory) {
  StateIndexSettings settings = Settings();
  settings.path = folder_.Path() / "missing" / "a.index";
  StateIndex index(settings);
  EXPECT_FALSE(index.IsOnDisk());
  index.Add(10, StateOf(10));
  EXPECT_EQ(index.Read(10), StateOf(10));
}

TEST_F(StateIndexTest, ManyThreadsMayUseIt) {
  StateIndex index(Settings());
  std::vector<std::thread> threads;
  for (std::uint64_t first = 0; first < 4; ++first) {
    threads.emplace_back([&index, first] {
      for (std::uint64_t tick = first; tick < 200; tick += 3) {
        index.Add(tick, StateOf(tick));
        const auto at = index.FindBefore(tick);
        if (at) index.Read(*at);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t tick : index.Ticks()) EXPECT_EQ(index.Read(tick), StateOf(tick));
  EXPECT_GT(index.Ticks().size(), 190u);
}

}  // namespace
}  // namespace trocar::record
