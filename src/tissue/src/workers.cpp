// SPDX-License-Identifier: Apache-2.0
#include "workers.h"

#include <oneapi/tbb/info.h>

#include <thread>

#include "trocar/core/assert.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace trocar::tissue {
namespace {

/// Looks at a flag before the processor is offered to somebody else: about 20 microseconds.
constexpr int kPatience = 500;

void Pause(int& looks) noexcept {
  if (++looks >= kPatience) {
    looks = 0;
    std::this_thread::yield();
    return;
  }
#if defined(__x86_64__)
  _mm_pause();
#endif
}

}  // namespace

Workers::Workers(int threads) : threads_(threads) {
  TROCAR_ASSERT(threads >= 1);
  if (threads > tbb::info::default_concurrency()) {
    more_workers_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  }
  if (threads > 1) arena_.initialize(threads);
}

Workers::Session::Session(Workers& workers) noexcept : workers_(workers) {
  if (workers_.threads_ == 1) return;
  workers_.is_open_.store(true);
  workers_.arena_.execute([this] {
    for (int seat = 1; seat < workers_.threads_; ++seat) {
      workers_.helpers_.run([this, seat] { workers_.Help(seat); });
    }
  });
}

Workers::Session::~Session() {
  if (workers_.threads_ == 1) return;
  workers_.is_open_.store(false);
  workers_.arena_.execute([this] { workers_.helpers_.wait(); });
}

void Workers::Help(int seat) noexcept {
  std::uint64_t seen = 0;
  int looks = 0;
  while (is_open_.load(std::memory_order_acquire)) {
    const std::uint64_t word = loop_.load(std::memory_order_acquire);
    if (word == seen) {
      Pause(looks);
      continue;
    }
    seen = word;
    TakeChunks(Loop(word), seat);
  }
}

void Workers::TakeChunks(Loop loop, int seat) noexcept {
  // each begins where its share begins, so that a chunk mostly stays in the same processor's cache
  const auto begin = static_cast<std::uint32_t>(std::uint64_t{loop.count} * static_cast<std::uint64_t>(seat) /
                                                static_cast<std::uint64_t>(threads_));
  std::uint32_t done = 0;
  for (std::uint32_t i = 0; i < loop.count; ++i) {
    const std::uint32_t chunk = begin + i < loop.count ? begin + i : begin + i - loop.count;
    std::atomic<std::uint64_t>& taken_by = chunks_[chunk].taken_by;
    std::uint64_t last = taken_by.load(std::memory_order_relaxed);
    // Taken in this loop or, if we are late, in a later one. Otherwise this loop has not ended, and does not before
    // the chunk is done: call and context are its own.
    if (last >= loop.number ||
        !taken_by.compare_exchange_strong(last, loop.number, std::memory_order_acq_rel)) {
      continue;
    }
    call_.load(std::memory_order_relaxed)(context_.load(std::memory_order_relaxed), chunk);
    ++done;
  }
  if (done > 0) done_.fetch_add(done, std::memory_order_acq_rel);
}

void Workers::RunShared(std::uint32_t count, Call call, const void* context) noexcept {
  TROCAR_ASSERT(count <= kMaxChunks);
  call_.store(call, std::memory_order_relaxed);
  context_.store(context, std::memory_order_relaxed);
  done_.store(0, std::memory_order_relaxed);
  const Loop loop(Loop(loop_.load(std::memory_order_relaxed)).number + 1, count);
  loop_.store(loop.Word(), std::memory_order_release);
  TakeChunks(loop, 0);
  int looks = 0;
  while (done_.load(std::memory_order_acquire) != count) Pause(looks);
}

}  // namespace trocar::tissue
