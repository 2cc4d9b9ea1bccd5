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
  std::uint32_t seen = 0;
  int looks = 0;
  while (is_open_.load(std::memory_order_acquire)) {
    const std::uint32_t loop = loop_.load(std::memory_order_acquire);
    if (loop == seen) {
      Pause(looks);
      continue;
    }
    seen = loop;
    TakeChunks(loop, seat);
  }
}

void Workers::TakeChunks(std::uint32_t loop, int seat) noexcept {
  const std::uint32_t count = count_.load(std::memory_order_acquire);
  // each begins where its share begins, so that a chunk mostly stays in the same processor's cache
  const auto begin = static_cast<std::uint32_t>(std::uint64_t{count} * static_cast<std::uint64_t>(seat) /
                                                static_cast<std::uint64_t>(threads_));
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t chunk = begin + i < count ? begin + i : begin + i - count;
    std::uint32_t last = taken_[chunk].load(std::memory_order_relaxed);
    // taken in this loop or, if we are late, in a later one
    if (static_cast<std::int32_t>(loop - last) <= 0 ||
        !taken_[chunk].compare_exchange_strong(last, loop, std::memory_order_acq_rel)) {
      continue;
    }
    // A helper that was late may hold a chunk of a loop that has ended. A loop ends only after its last
    // chunk, so a chunk of the present loop keeps it present.
    if (loop_.load(std::memory_order_acquire) != loop || chunk >= count_.load(std::memory_order_acquire))
      return;
    call_.load(std::memory_order_acquire)(context_.load(std::memory_order_acquire), chunk);
    done_.fetch_add(1, std::memory_order_acq_rel);
  }
}

void Workers::RunShared(std::uint32_t count, Call call, const void* context) noexcept {
  TROCAR_ASSERT(count <= kMaxChunks);
  call_.store(call, std::memory_order_relaxed);
  context_.store(context, std::memory_order_relaxed);
  count_.store(count, std::memory_order_relaxed);
  done_.store(0, std::memory_order_relaxed);
  const std::uint32_t loop = loop_.load(std::memory_order_relaxed) + 1;
  loop_.store(loop, std::memory_order_release);
  TakeChunks(loop, 0);
  int looks = 0;
  while (done_.load(std::memory_order_acquire) != count) Pause(looks);
}

}  // namespace trocar::tissue
