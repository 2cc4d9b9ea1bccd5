// SPDX-License-Identifier: Apache-2.0
/// \file clock.h  Monotonic time for measuring. No simulation result may depend on it.
#pragma once

#include <cstdint>

namespace trocar::host {

/// Monotonic time since an arbitrary start [ns].
/// \note Real-time safe: no allocation, lock or throw.
std::int64_t NowNanoseconds() noexcept;

/// Processor time that the calling thread has used [ns]; steady on a busy machine where wall time is not.
/// \note Real-time safe.
std::int64_t ThreadCpuNanoseconds() noexcept;

/// Wall time since construction or Restart().
class Stopwatch {
 public:
  Stopwatch() noexcept : start_(NowNanoseconds()) {}
  void Restart() noexcept { start_ = NowNanoseconds(); }
  /// [s]
  double Seconds() const noexcept { return 1e-9 * static_cast<double>(NowNanoseconds() - start_); }

 private:
  std::int64_t start_;
};

}  // namespace trocar::host
