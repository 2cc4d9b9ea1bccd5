// SPDX-License-Identifier: Apache-2.0
#include "workers.h"

#include <algorithm>
#include <thread>

#include "trocar/base/assert.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace trocar::tissue {
namespace {

/// Reads of a flag before the thread yields its processor: about 20 microseconds.
constexpr int kSpinLimit = 500;

void Pause(int& spins) noexcept {
  if (++spins >= kSpinLimit) {
    spins = 0;
    std::this_thread::yield();
    return;
  }
#if defined(__x86_64__)
  _mm_pause();
#endif
}

}  // namespace

Workers::Workers(const base::Threads& threads)
    : threads_(threads.count), slots_(static_cast<std::size_t>(std::max(threads.count, 1))) {
  TROCAR_ASSERT(threads.count >= 1 && (threads.count == 1 || threads.make_crew != nullptr));
  if (threads.count > 1) crew_ = threads.make_crew(threads.count);
}

Workers::Session::Session(Workers& workers) noexcept : workers_(workers) {
  if (workers_.threads_ == 1) return;
  workers_.is_open_.store(true);
  workers_.crew_->Begin([](void* context, int slot) { static_cast<Workers*>(context)->Serve(slot); },
                        &workers_);
}

Workers::Session::~Session() {
  if (workers_.threads_ == 1) return;
  workers_.is_open_.store(false);
  workers_.crew_->End();
}

void Workers::Serve(int slot) noexcept {
  std::uint64_t seen = 0;
  int spins = 0;
  while (is_open_.load(std::memory_order_acquire)) {
    const std::uint64_t word = loop_.load(std::memory_order_acquire);
    if (word == seen) {
      Pause(spins);
      continue;
    }
    seen = word;
    (void)TakeChunks(Loop(word), slot);
  }
}

std::uint32_t Workers::Begin(Loop loop, int slot) const noexcept {
  return static_cast<std::uint32_t>(std::uint64_t{loop.count} * static_cast<std::uint64_t>(slot) /
                                    static_cast<std::uint64_t>(threads_));
}

std::uint32_t Workers::TakeShare(Loop loop, int slot) noexcept {
  std::atomic<std::uint64_t>& taken = slots_[static_cast<std::size_t>(slot)].taken;
  const std::uint32_t end = Begin(loop, slot + 1);
  std::uint64_t word = taken.load(std::memory_order_relaxed);
  for (std::uint32_t done = 0;;) {
    // Where a later loop has taken from here, we are late. Otherwise, if a chunk is left, this loop has not ended, and
    // does not before the chunk is done: call and context are its own.
    const Loop last(word);
    const std::uint32_t chunk = last.number == loop.number ? last.count : Begin(loop, slot);
    if (last.number > loop.number || chunk >= end) return done;
    const std::uint64_t next = Loop(loop.number, chunk + 1).Word();
    if (!taken.compare_exchange_weak(word, next, std::memory_order_acq_rel)) continue;
    word = next;
    call_.load(std::memory_order_relaxed)(context_.load(std::memory_order_relaxed), chunk);
    ++done;
  }
}

std::uint32_t Workers::TakeChunks(Loop loop, int slot) noexcept {
  // its own share first, so that a chunk mostly stays in the same processor's cache
  std::uint32_t done = 0;
  for (int i = 0; i < threads_; ++i) {
    const std::uint32_t more = TakeShare(loop, (slot + i) % threads_);
    done += more;
    if (more > 0 && slot > 0) {
      slots_[static_cast<std::size_t>(slot)].done.store(Loop(loop.number, done).Word(),
                                                        std::memory_order_release);
    }
  }
  return done;
}

bool Workers::AreDone(Loop loop, std::uint32_t by_caller) const noexcept {
  std::uint32_t done = by_caller;
  for (std::size_t slot = 1; slot < slots_.size(); ++slot) {
    const Loop last(slots_[slot].done.load(std::memory_order_acquire));
    if (last.number == loop.number) done += last.count;
  }
  return done == loop.count;
}

void Workers::RunShared(std::uint32_t count, Call call, const void* context) noexcept {
  TROCAR_ASSERT(count <= kMaxChunks);
  call_.store(call, std::memory_order_relaxed);
  context_.store(context, std::memory_order_relaxed);
  const Loop loop(Loop(loop_.load(std::memory_order_relaxed)).number + 1, count);
  loop_.store(loop.Word(), std::memory_order_release);
  const std::uint32_t done = TakeChunks(loop, 0);
  int spins = 0;
  while (!AreDone(loop, done)) Pause(spins);
}

}  // namespace trocar::tissue
