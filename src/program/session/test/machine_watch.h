// SPDX-License-Identifier: Apache-2.0
/// \file machine_watch.h  Whether the machine itself ran: a virtual one is stopped for milliseconds now and then, and nothing in it
/// is to blame for what comes late then.
#pragma once

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "trocar/host/clock.h"
#include "trocar/host/real_time.h"

namespace trocar::session {

/// A thread on each processor that goes before everybody else and wakes five times a millisecond. When it comes late, nobody
/// ran on that processor; without real-time priority it knows less, and its absence is that of any thread.
class MachineWatch {
 public:
  MachineWatch() {
    cpu_set_t allowed;
    ::sched_getaffinity(0, sizeof allowed, &allowed);
    for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
      if (CPU_ISSET(cpu, &allowed)) threads_.emplace_back([this, cpu] { Run(cpu); });
    }
  }
  ~MachineWatch() {
    is_ending_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  MachineWatch(const MachineWatch&) = delete;
  MachineWatch& operator=(const MachineWatch&) = delete;

  void Forget() { longest_ = 0; }
  /// Longest time since Forget() in which a processor did not run [s].
  double LongestAbsence() const { return 1e-9 * static_cast<double>(longest_.load()); }

 private:
  static constexpr std::int64_t kNap = 200'000;  // [ns]

  void Run(int cpu) {
    cpu_set_t own;
    CPU_ZERO(&own);
    CPU_SET(cpu, &own);
    ::pthread_setaffinity_np(::pthread_self(), sizeof own, &own);
    static_cast<void>(host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, 90));
    std::int64_t last = host::NowNanoseconds();
    while (!is_ending_) {
      const timespec nap{0, kNap};
      ::nanosleep(&nap, nullptr);
      const std::int64_t now = host::NowNanoseconds();
      const std::int64_t absence = now - last - kNap;
      for (std::int64_t known = longest_;
           absence > known && !longest_.compare_exchange_weak(known, absence);) {
      }
      last = now;
    }
  }

  std::vector<std::thread> threads_;
  std::atomic<std::int64_t> longest_{0};
  std::atomic<bool> is_ending_{false};
};

}  // namespace trocar::session
