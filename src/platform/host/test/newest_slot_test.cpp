// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/newest_slot.h"

#include <gtest/gtest.h>

#include <thread>

namespace trocar::host {
namespace {

TEST(NewestSlot, DeliversOnlyTheNewestValueAndOnlyOnce) {
  NewestSlot<int> slot;
  EXPECT_FALSE(slot.Update());
  for (int value = 1; value <= 3; ++value) {
    slot.Back() = value;
    slot.Publish();
  }
  EXPECT_TRUE(slot.Update());
  EXPECT_EQ(slot.Front(), 3);
  EXPECT_FALSE(slot.Update());
  EXPECT_EQ(slot.Front(), 3);
}

TEST(NewestSlot, NeverShowsAHalfWrittenOrOlderValueAcrossThreads) {
  struct Pair {
    long first = 0;
    long second = 0;
  };
  constexpr long kCount = 200'000;
  NewestSlot<Pair> slot;
  std::thread producer([&] {
    for (long value = 1; value <= kCount; ++value) {
      slot.Back() = {value, -value};
      slot.Publish();
    }
  });
  long last = 0;
  while (last < kCount) {
    if (!slot.Update()) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(slot.Front().first, -slot.Front().second);
    ASSERT_GT(slot.Front().first, last);
    last = slot.Front().first;
  }
  producer.join();
}

}  // namespace
}  // namespace trocar::host
