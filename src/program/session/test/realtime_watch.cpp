// SPDX-License-Identifier: Apache-2.0
#include "realtime_watch.h"

#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/select.h>
#include <time.h>
#include <unistd.h>

#include <cstddef>

namespace {
thread_local int t_watching = 0;
thread_local trocar::session::RealtimeCounts t_counts;
}  // namespace

namespace trocar::session {

RealtimeWatch::RealtimeWatch() {
  ++t_watching;
}
RealtimeWatch::~RealtimeWatch() {
  --t_watching;
}
RealtimeCounts RealtimeWatch::Counts() {
  return t_counts;
}

}  // namespace trocar::session

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

bool trocar::session::RealtimeWatch::IsAvailable() {
  return false;
}

#else

bool trocar::session::RealtimeWatch::IsAvailable() {
  return true;
}

namespace {
void NoteAllocation() {
  if (t_watching > 0) ++t_counts.allocations;
}
void NoteLock() {
  if (t_watching > 0) ++t_counts.locks;
}
void NoteWait() {
  if (t_watching > 0) ++t_counts.waits;
}
}  // namespace

// the next definition of the same name, found once
#define TROCAR_NEXT(function) \
  static const auto next = reinterpret_cast<decltype(&::function)>(::dlsym(RTLD_NEXT, #function))

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) noexcept {
  NoteAllocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  NoteAllocation();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  NoteAllocation();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  NoteAllocation();
  return __libc_memalign(alignment, size);
}
void free(void* memory) noexcept {
  NoteAllocation();
  __libc_free(memory);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  NoteLock();
  TROCAR_NEXT(pthread_mutex_lock);
  return next(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
  NoteLock();
  TROCAR_NEXT(pthread_rwlock_rdlock);
  return next(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
  NoteLock();
  TROCAR_NEXT(pthread_rwlock_wrlock);
  return next(lock);
}
int sem_wait(sem_t* semaphore) {
  NoteLock();
  TROCAR_NEXT(sem_wait);
  return next(semaphore);
}
int nanosleep(const timespec* wanted, timespec* left) {
  NoteWait();
  TROCAR_NEXT(nanosleep);
  return next(wanted, left);
}
int clock_nanosleep(clockid_t clock, int flags, const timespec* wanted, timespec* left) {
  NoteWait();
  TROCAR_NEXT(clock_nanosleep);
  return next(clock, flags, wanted, left);
}
int poll(pollfd* files, nfds_t count, int timeout) {
  NoteWait();
  TROCAR_NEXT(poll);
  return next(files, count, timeout);
}
int select(int count, fd_set* reads, fd_set* writes, fd_set* errors, timeval* timeout) {
  NoteWait();
  TROCAR_NEXT(select);
  return next(count, reads, writes, errors, timeout);
}
ssize_t read(int file, void* bytes, std::size_t size) {
  NoteWait();
  TROCAR_NEXT(read);
  return next(file, bytes, size);
}
}  // extern "C"

#endif
