// SPDX-License-Identifier: Apache-2.0
/// \file processor_time.h  Time that other processes on a shared machine do not lengthen.
#pragma once

#include <algorithm>
#include <ctime>
#include <limits>

#include "trocar/host/clock.h"

namespace trocar::bench {

/// Processor time of this process where one thread works; the clock's where several do, whose processor times add up.
class WorkStopwatch {
 public:
  explicit WorkStopwatch(int threads) : counts_processor_(threads == 1), start_(ProcessorSeconds()) {}
  /// Since it was made [s].
  double Seconds() const { return counts_processor_ ? ProcessorSeconds() - start_ : clock_.Seconds(); }

 private:
  static double ProcessorSeconds() {
    std::timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }
  bool counts_processor_;
  double start_;
  host::Stopwatch clock_;
};

/// As TimeShortest of benchmark.h, by WorkStopwatch [s].
template <typename Restore, typename Run>
double TimeShortestWork(int threads, int repeats, const Restore& restore, const Run& run) {
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= repeats; ++i) {
    restore();
    const WorkStopwatch stopwatch(threads);
    run();
    if (i > 0 || repeats == 0) shortest = std::min(shortest, stopwatch.Seconds());
  }
  return shortest;
}

}  // namespace trocar::bench
