// SPDX-License-Identifier: Apache-2.0
#include "workers.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "trocar_test/threads.h"

namespace trocar::tissue {
namespace {

// A worker that comes late to a loop finds it at its end, and may look at the next, of more chunks, while that is being
// set up. Loops of next to nothing, long and short by turns, make workers late at every step of it.
TEST(Workers, DoEachChunkOnceHoweverLateAWorkerIs) {
  constexpr std::uint32_t kFew = 2, kMany = 4;
  constexpr int kLoops = 2'000'000;
  for (const int threads : {2, 3}) {
    Workers workers(test::UseThreads(threads));
    const Workers::Session session(workers);
    std::array<std::atomic<int>, kMany> times{};
    for (int loop = 0; loop < kLoops; ++loop) {
      const std::uint32_t count = loop % 2 == 0 ? kFew : kMany;
      workers.Run(count, [&](std::uint32_t chunk) {
        const std::uint32_t dawdle = (static_cast<std::uint32_t>(loop) * 7 + chunk * 13) % 64;
        for (std::uint32_t turn = 0; turn < dawdle; ++turn) times[chunk].load();
        ++times[chunk];
      });
      for (std::uint32_t chunk = 0; chunk < kMany; ++chunk) {
        const int due = chunk < kFew ? loop + 1 : (loop + 1) / 2;
        ASSERT_EQ(times[chunk], due) << threads << " threads, loop " << loop << ", chunk " << chunk;
      }
    }
  }
}

// Without a session no worker is awake: the caller takes everybody's share.
TEST(Workers, TheCallerDoesWhatNobodyHasBegun) {
  for (const int threads : {2, 3, 8}) {
    Workers workers(test::UseThreads(threads));
    for (const std::uint32_t count : {2u, 5u, Workers::kMaxChunks}) {
      std::vector<int> times(count);
      workers.Run(count, [&](std::uint32_t chunk) { ++times[chunk]; });
      EXPECT_EQ(times, std::vector<int>(count, 1)) << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace trocar::tissue
