// SPDX-License-Identifier: Apache-2.0
/// \file realtime_watch.h  Counts what a real-time thread must not do: it stands between the program and the C library.
#pragma once

namespace trocar::session {

struct RealtimeCounts {
  long allocations = 0;  ///< malloc, calloc, realloc, free, aligned_alloc
  long locks = 0;        ///< mutexes, reader-writer locks, conditions, semaphores
  long waits = 0;        ///< sleep, poll, select, read
};

/// Counts the calls of this thread while it lives.
class RealtimeWatch {
 public:
  RealtimeWatch();
  ~RealtimeWatch();
  RealtimeWatch(const RealtimeWatch&) = delete;
  RealtimeWatch& operator=(const RealtimeWatch&) = delete;
  static RealtimeCounts Counts();  ///< of this thread, over all watches
  /// False under a sanitizer, which stands there itself.
  static bool IsAvailable();
};

}  // namespace trocar::session
