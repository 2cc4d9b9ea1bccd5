// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "block_executor.h"

namespace trocar::tissue_cuda {
namespace {

/// Reverses a block's numbers through shared memory, then adds the first number of the next block.
template <typename Memory>
struct ReverseAndAdd {
  struct Args {
    std::uint32_t count = 0;
    typename Memory::template Array<int> values{}, result{};
  };
  struct Shared {
    typename Memory::template Array<int> tile;
  };
  struct Registers {
    int rounds = 0;
  };
  // read, [reverse, add]
  static constexpr int kPhases = 3, kLoopBegin = 1, kLoopEnd = 3;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kBlock, Barrier::kGrid, Barrier::kGrid};

  template <typename Allocator>
  static Shared MakeShared(Allocator& allocator, const Args&) {
    return {allocator.template Array<int>(8)};
  }
  static bool GoesOn(const Registers& registers) { return registers.rounds < 3; }

  template <int kPhase>
  static void Run(const ThreadIndex& where, const Args& args, Shared& shared, Registers& registers) {
    const std::uint32_t i = where.block * where.threads_per_block + where.thread;
    const bool is_inside = i < args.count;
    if constexpr (kPhase == 0) {
      if (is_inside) Store(shared.tile, where.thread, Load(args.values, i));
    } else if constexpr (kPhase == 1) {
      if (is_inside) Store(args.result, i, Load(shared.tile, where.threads_per_block - 1 - where.thread));
    } else {
      const std::uint32_t next = (where.block + 1) % where.blocks * where.threads_per_block;
      if (is_inside) Store(args.values, i, Load(args.result, i) + Load(args.result, next));
      ++registers.rounds;
    }
  }
};

struct Outcome {
  std::vector<int> values;
  std::size_t errors = 0;
};

Outcome RunReverse(const ExecutorOptions& options, bool has_input = true) {
  Watch watch;
  CheckedHeap heap(watch);
  std::vector<int> numbers(24);
  for (int i = 0; i < 24; ++i) numbers[static_cast<std::size_t>(i)] = i * i;
  ReverseAndAdd<CheckedMemory>::Args args;
  args.count = 24;
  args.values = has_input ? heap.Filled("values", numbers) : heap.Array<int>("values", 24);
  args.result = heap.Array<int>("result", 24);
  EXPECT_TRUE(RunChecked<ReverseAndAdd<CheckedMemory>>(args, 3, 8, options, watch));
  return {args.values.contents->values, watch.error_count};
}

TEST(Executor, GivesTheSameAnswerInAnyOrderOfThreads) {
  const Outcome in_order = RunReverse({});
  EXPECT_EQ(in_order.errors, 0u);
  EXPECT_EQ(in_order.values[0], 7 * 7 + 15 * 15);
  for (std::uint32_t seed = 1; seed < 6; ++seed) {
    const Outcome shuffled = RunReverse({seed});
    EXPECT_EQ(shuffled.errors, 0u);
    EXPECT_EQ(shuffled.values, in_order.values);
  }
}

// Negative controls: without a barrier the executor complains.
TEST(Executor, FindsTheMissingBlockBarrier) {
  EXPECT_GT(RunReverse({0, 0}).errors, 0u);
  EXPECT_GT(RunReverse({3, 0}).errors, 0u);
}

TEST(Executor, FindsTheMissingGridBarrier) {
  EXPECT_GT(RunReverse({0, 1}).errors, 0u);
}

TEST(Executor, FindsReadsOfWhatNobodyWrote) {
  EXPECT_EQ(RunReverse({}, false).errors, 24u);
}

/// Each thread writes where it is told to.
template <typename Memory>
struct WriteThere {
  struct Args {
    std::uint32_t offset = 0, stride = 1;
    typename Memory::template Array<int> result{};
  };
  struct Shared {};
  struct Registers {};
  static constexpr int kPhases = 1, kLoopBegin = 1, kLoopEnd = 1;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kNone};
  template <typename Allocator>
  static Shared MakeShared(Allocator&, const Args&) {
    return {};
  }
  static bool GoesOn(const Registers&) { return false; }
  template <int kPhase>
  static void Run(const ThreadIndex& where, const Args& args, Shared&, Registers&) {
    Store(args.result, args.offset + args.stride * where.thread, 1);
  }
};

std::vector<std::string> RunWrite(std::uint32_t offset, std::uint32_t stride) {
  Watch watch;
  CheckedHeap heap(watch);
  WriteThere<CheckedMemory>::Args args{offset, stride, heap.Array<int>("result", 8)};
  EXPECT_TRUE(RunChecked<WriteThere<CheckedMemory>>(args, 1, 8, {}, watch));
  return watch.errors;
}

TEST(Executor, FindsWritesBeyondTheEndAndWhereItWas) {
  EXPECT_TRUE(RunWrite(0, 1).empty());
  const auto errors = RunWrite(1, 1);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0], "result[8]: written beyond its end, block 0, thread 7");
}

TEST(Executor, FindsTwoThreadsThatWriteOnePlace) {
  EXPECT_EQ(RunWrite(0, 0).size(), 7u);
}

/// Counts down a different number of rounds in every thread.
template <typename Memory>
struct Disagree {
  struct Args {};
  struct Shared {};
  struct Registers {
    std::uint32_t rounds = 0, wanted = 0;
  };
  static constexpr int kPhases = 1, kLoopBegin = 0, kLoopEnd = 1;
  static constexpr Barrier kBarrier[kPhases] = {Barrier::kGrid};
  template <typename Allocator>
  static Shared MakeShared(Allocator&, const Args&) {
    return {};
  }
  static bool GoesOn(const Registers& registers) { return registers.rounds < registers.wanted; }
  template <int kPhase>
  static void Run(const ThreadIndex& where, const Args&, Shared&, Registers& registers) {
    registers.wanted = 1 + where.thread;
    ++registers.rounds;
  }
};

TEST(Executor, FindsThreadsThatWouldWaitForEver) {
  Watch watch;
  EXPECT_TRUE(RunChecked<Disagree<CheckedMemory>>({}, 2, 1, {}, watch));
  EXPECT_FALSE(RunChecked<Disagree<CheckedMemory>>({}, 2, 3, {}, watch));
}

}  // namespace
}  // namespace trocar::tissue_cuda
