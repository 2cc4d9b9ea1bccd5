// SPDX-License-Identifier: Apache-2.0
/// \file workers.h  Threads that share the chunks of short loops within one solve.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "trocar/base/threads.h"

namespace trocar::tissue {

/// A loop of an iterative solver takes some ten microseconds, less than it takes to wake a thread. Workers therefore stay
/// awake for the length of a solve (Session), spin between loops, and take chunks as they come. The calling thread waits
/// only for chunks that have been begun: a worker that never gets a processor delays nobody. What a chunk computes must not
/// depend on who runs it or when; then results do not depend on the threads.
class Workers {
 public:
  explicit Workers(const base::Threads& threads = {});
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int Threads() const { return threads_; }

  /// Keeps the workers awake while it lives.
  class Session {
   public:
    explicit Session(Workers& workers) noexcept;
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

   private:
    Workers& workers_;
  };

  /// Most chunks of one loop.
  static constexpr std::uint32_t kMaxChunks = 256;

  /// Calls work(chunk) for every chunk from 0 to count - 1, and returns when all are done.
  template <typename Work>
  void Run(std::uint32_t count, const Work& work) noexcept {
    if (threads_ == 1 || count < 2) {
      for (std::uint32_t chunk = 0; chunk < count; ++chunk) work(chunk);
      return;
    }
    RunShared(
        count, [](const void* context, std::uint32_t chunk) { (*static_cast<const Work*>(context))(chunk); },
        &work);
  }

 private:
  using Call = void (*)(const void*, std::uint32_t);

  /// A loop's number and its chunks in one word: a worker that is late must not read the count of the next loop.
  struct Loop {
    static constexpr std::uint64_t kPlaces = 2 * kMaxChunks;
    std::uint64_t number;
    std::uint32_t count;
    explicit Loop(std::uint64_t word) : number(word / kPlaces), count(word % kPlaces) {}
    Loop(std::uint64_t number_in, std::uint32_t count_in) : number(number_in), count(count_in) {}
    std::uint64_t Word() const { return number * kPlaces + count; }
  };

  // each of what different threads write at the same time has a cache line of its own: to fetch one from another processor
  // takes a tenth of a microsecond, and an iteration has some twenty loops
  static constexpr std::size_t kLine = 64;
  /// One thread's share of the chunks; others take from it when their own is done. See Loop.
  struct Slot {
    alignas(kLine) std::atomic<std::uint64_t> taken = 0;  // last loop that took from it; the next chunk
    alignas(kLine) std::atomic<std::uint64_t> done = 0;   // last loop that the thread worked in; chunks done
  };

  void RunShared(std::uint32_t count, Call call, const void* context) noexcept;
  /// Does what is left of the thread's share, then of the others'.
  /// \return chunks that it did
  std::uint32_t TakeChunks(Loop loop, int slot) noexcept;
  std::uint32_t TakeShare(Loop loop, int slot) noexcept;
  /// First chunk of a share.
  std::uint32_t Begin(Loop loop, int slot) const noexcept;
  bool AreDone(Loop loop, std::uint32_t by_caller) const noexcept;
  void Serve(int slot) noexcept;

  int threads_;
  std::unique_ptr<base::Crew> crew_;  // of more than one thread

  alignas(kLine) std::atomic<bool> is_open_ = false;
  std::atomic<std::uint64_t> loop_ = 0;  // the present one, see Loop
  std::atomic<Call> call_ = nullptr;
  std::atomic<const void*> context_ = nullptr;
  alignas(kLine) std::vector<Slot> slots_;  // (threads_), the caller's first
};

}  // namespace trocar::tissue
