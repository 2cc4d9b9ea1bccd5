// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/threads.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>

namespace trocar::host {
namespace {

TEST(UseThreads, LetsEachMemberServeOnceAndWaitsForAll) {
  constexpr int kCount = 5;  // more than there may be processors
  const base::Threads threads = UseThreads(kCount);
  ASSERT_EQ(threads.count, kCount);
  const auto crew = threads.make_crew(kCount);
  std::array<std::atomic<int>, kCount> times{};
  for (int turn = 1; turn <= 100; ++turn) {
    crew->Begin(
        [](void* context, int member) {
          ++(*static_cast<decltype(times)*>(context))[static_cast<std::size_t>(member)];
        },
        &times);
    crew->End();
    for (std::size_t member = 1; member < kCount; ++member) ASSERT_EQ(times[member], turn);
  }
  EXPECT_EQ(times[0], 0) << "the caller is no member";
}

TEST(UseThreads, TakesAnyCountForAtLeastOne) {
  EXPECT_EQ(UseThreads(0).count, 1);
  EXPECT_EQ(UseThreads(-3).count, 1);
}

}  // namespace
}  // namespace trocar::host
