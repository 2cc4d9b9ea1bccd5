// SPDX-License-Identifier: Apache-2.0
/// \file block_executor.h  Runs a kernel's phases on the host as the GPU would: a grid of blocks of threads,
/// barriers between phases, shared memory that begins poisoned, and any order of threads and blocks that
/// barriers allow. So index arithmetic, borders and tails are tested without a GPU.
#pragma once

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "checked_memory.h"
#include "trocar/math/random.h"

namespace trocar::tissue_cuda {

struct ExecutorOptions {
  std::uint32_t seed = 0;    ///< 0 runs threads and blocks in order, others shuffle them
  int removed_barrier = -1;  ///< a barrier that the executor leaves out: a negative control for tests
};

/// One block's shared memory, with raw pointers and poisoned bytes, or with checked arrays.
class RawBlockMemory {
 public:
  template <typename Kernel>
  void Prepare(const typename Kernel::Args& args) {
    SharedLayout measure(nullptr);
    (void)Kernel::MakeShared(measure, args);
    bytes_.assign(measure.Bytes() / sizeof(Key) + 2, ~Key{0});
  }
  template <typename Kernel>
  typename Kernel::Shared MakeShared(const typename Kernel::Args& args) {
    auto* begin = reinterpret_cast<unsigned char*>(bytes_.data());
    SharedLayout layout(begin + (16 - reinterpret_cast<std::uintptr_t>(begin) % 16) % 16);
    return Kernel::MakeShared(layout, args);
  }

 private:
  std::vector<Key> bytes_;
};

/// Runs one launch of a kernel.
///
/// \param watch  of checked arrays, told who runs; null with raw ones
/// \return false if threads of a grid disagree on whether to go on: on a GPU, a deadlock
template <typename Kernel, typename MakeBlockShared>
class GridRun {
 public:
  using Args = typename Kernel::Args;

  GridRun(const Args& args, std::uint32_t blocks, std::uint32_t threads, const ExecutorOptions& options,
          Watch* watch, const MakeBlockShared& make_shared)
      : args_(args),
        blocks_(blocks),
        threads_(threads),
        options_(options),
        watch_(watch),
        random_(options.seed) {
    registers_.resize(static_cast<std::size_t>(blocks) * threads);
    for (std::uint32_t block = 0; block < blocks; ++block) shared_.push_back(make_shared(block));
    if (watch_ != nullptr) ++watch_->grid_epoch, ++watch_->block_epoch;
  }

  bool Run() {
    RunPhases<0, Kernel::kLoopBegin>();
    if constexpr (Kernel::kLoopBegin < Kernel::kLoopEnd) {
      bool goes_on = true;
      while (goes_on) {
        RunPhases<Kernel::kLoopBegin, Kernel::kLoopEnd>();
        goes_on = Kernel::GoesOn(registers_[0]);
        for (const auto& registers : registers_) {
          if (Kernel::GoesOn(registers) != goes_on) return false;
        }
      }
    }
    RunPhases<Kernel::kLoopEnd, Kernel::kPhases>();
    return true;
  }

 private:
  /// First phase behind kFirst's next kept barrier of the grid, at most kEnd.
  template <int kFirst, int kEnd>
  static constexpr int GridStretchEnd() {
    int end = kFirst;
    while (end < kEnd && Kernel::kBarrier[end] != Barrier::kGrid) ++end;
    return end < kEnd ? end + 1 : end;
  }

  template <int kFirst, int kEnd>
  void RunPhases() {
    if constexpr (kFirst < kEnd) {
      constexpr int kStretch = GridStretchEnd<kFirst, kEnd>();
      for (const std::uint32_t block : Shuffled(blocks_)) RunBlock<kFirst, kStretch>(block);
      const bool is_grid_barrier = Kernel::kBarrier[kStretch - 1] == Barrier::kGrid;
      if (watch_ != nullptr && is_grid_barrier && options_.removed_barrier != kStretch - 1)
        ++watch_->grid_epoch;
      RunPhases<kStretch, kEnd>();
    }
  }

  /// Phases of one block, barrier after barrier.
  template <int kFirst, int kEnd>
  void RunBlock(std::uint32_t block) {
    if constexpr (kFirst < kEnd) {
      if (kFirst + 1 < kEnd && options_.removed_barrier == kFirst) {
        // without the barrier a thread runs on into the next phase
        for (const std::uint32_t thread : Shuffled(threads_)) {
          RunThread<kFirst>(block, thread);
          if constexpr (kFirst + 1 < kEnd) RunThread<kFirst + 1>(block, thread);
        }
        if constexpr (kFirst + 1 < kEnd) PassBarrier<kFirst + 1>();
        RunBlock<kFirst + 2, kEnd>(block);
        return;
      }
      for (const std::uint32_t thread : Shuffled(threads_)) RunThread<kFirst>(block, thread);
      PassBarrier<kFirst>();
      RunBlock<kFirst + 1, kEnd>(block);
    }
  }

  template <int kPhase>
  void PassBarrier() {
    if (watch_ != nullptr && Kernel::kBarrier[kPhase] != Barrier::kNone &&
        options_.removed_barrier != kPhase) {
      ++watch_->block_epoch;
    }
  }

  template <int kPhase>
  void RunThread(std::uint32_t block, std::uint32_t thread) {
    const ThreadIndex where{thread, block, threads_, blocks_};
    if (watch_ != nullptr) watch_->where = where;
    Kernel::template Run<kPhase>(where, args_, shared_[block],
                                 registers_[static_cast<std::size_t>(block) * threads_ + thread]);
  }

  std::vector<std::uint32_t> Shuffled(std::uint32_t count) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    if (options_.seed != 0) {
      for (std::uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random_.NextWord() % i]);
    }
    return order;
  }

  const Args& args_;
  std::uint32_t blocks_, threads_;
  ExecutorOptions options_;
  Watch* watch_;
  math::Random random_;
  std::vector<typename Kernel::Registers> registers_;
  std::vector<typename Kernel::Shared> shared_;
};

/// Runs a kernel on checked arrays.
template <typename Kernel>
bool RunChecked(const typename Kernel::Args& args, std::uint32_t blocks, std::uint32_t threads,
                const ExecutorOptions& options, Watch& watch) {
  std::vector<CheckedHeap> heaps;
  heaps.reserve(blocks);
  const auto make_shared = [&](std::uint32_t block) {
    CheckedHeap& heap = heaps.emplace_back(watch, "shared " + std::to_string(block) + " array ");
    return Kernel::MakeShared(heap, args);
  };
  return GridRun<Kernel, decltype(make_shared)>(args, blocks, threads, options, &watch, make_shared).Run();
}

/// Runs a kernel on raw pointers, as a stand-in for a GPU.
template <typename Kernel>
bool RunRaw(const typename Kernel::Args& args, std::uint32_t blocks, std::uint32_t threads,
            const ExecutorOptions& options = {}) {
  std::vector<RawBlockMemory> memory(blocks);
  const auto make_shared = [&](std::uint32_t block) {
    memory[block].template Prepare<Kernel>(args);
    return memory[block].template MakeShared<Kernel>(args);
  };
  return GridRun<Kernel, decltype(make_shared)>(args, blocks, threads, options, nullptr, make_shared).Run();
}

}  // namespace trocar::tissue_cuda
