// SPDX-License-Identifier: Apache-2.0
/// \file priority_mutex.h  A mutex that a real-time thread may share with ordinary ones.
#pragma once

#include <pthread.h>

namespace trocar::host {

/// Lends its holder the priority of the thread that waits for it (PTHREAD_PRIO_INHERIT), so that a third thread cannot keep both waiting.
/// For std::lock_guard. What is done under it is short and neither allocates nor waits.
class PriorityMutex {
 public:
  PriorityMutex() noexcept {
    pthread_mutexattr_t attributes;
    ::pthread_mutexattr_init(&attributes);
    // a system that has no such protocol makes a plain mutex
    ::pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    ::pthread_mutex_init(&mutex_, &attributes);
    ::pthread_mutexattr_destroy(&attributes);
  }
  ~PriorityMutex() { ::pthread_mutex_destroy(&mutex_); }
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock() noexcept { ::pthread_mutex_lock(&mutex_); }      // NOLINT: std::lock_guard calls it so
  void unlock() noexcept { ::pthread_mutex_unlock(&mutex_); }  // NOLINT

 private:
  pthread_mutex_t mutex_;
};

}  // namespace trocar::host
