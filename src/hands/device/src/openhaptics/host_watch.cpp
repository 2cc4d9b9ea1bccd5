// SPDX-License-Identifier: Apache-2.0
#include "host_watch.h"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

// glibc 2.36 declares these for C only
extern "C" {
#include <sys/pidfd.h>
}

namespace trocar::device {
namespace {

/// A killed process ends only once each of its threads is given a processor; one that others keep from it gets any of them, and
/// goes first.
void LetEnd(int process) noexcept {
  constexpr int kPriorityAboveLowest = 18;  // above the loop and the libraries' processes
  char tasks[32];
  std::snprintf(tasks, sizeof tasks, "/proc/%d/task", process);
  DIR* const folder = ::opendir(tasks);
  if (folder == nullptr) return;
  cpu_set_t all;
  std::memset(&all, 0xff, sizeof all);
  sched_param first{};
  first.sched_priority = ::sched_get_priority_min(SCHED_FIFO) + kPriorityAboveLowest;
  while (const dirent* const entry = ::readdir(folder)) {
    const int thread = std::atoi(entry->d_name);
    if (thread <= 0) continue;
    static_cast<void>(::sched_setaffinity(thread, sizeof all, &all));
    static_cast<void>(::sched_setscheduler(thread, SCHED_FIFO, &first));
  }
  ::closedir(folder);
}

}  // namespace

HostWatch::HostWatch(int page, int process) noexcept : process_(::fcntl(process, F_DUPFD_CLOEXEC, 0)) {
  const void* memory = ::mmap(nullptr, sizeof(HdHostPage), PROT_READ, MAP_SHARED, page, 0);
  if (memory != MAP_FAILED) page_ = static_cast<const HdHostPage*>(memory);
  // one that cannot be watched is none
  if (page_ == nullptr || process_ < 0) state_ = State::kFailed;
}

HostWatch::HostWatch(HostWatch&& other) noexcept {
  *this = std::move(other);
}

HostWatch& HostWatch::operator=(HostWatch&& other) noexcept {
  std::swap(page_, other.page_);
  std::swap(process_, other.process_);
  watch_ = other.watch_;
  silence_ = other.silence_;
  has_looked_ = other.has_looked_;
  state_ = other.state_;
  return *this;
}

HostWatch::~HostWatch() {
  if (page_ != nullptr) ::munmap(const_cast<HdHostPage*>(page_), sizeof(HdHostPage));
  if (process_ >= 0) ::close(process_);
}

HostWatch::State HostWatch::Look(std::int64_t now) noexcept {
  if (state_ != State::kRunning || !kIsHostWatched) return state_;
  if (!std::exchange(has_looked_, true)) watch_.Forget(now);
  silence_ = watch_.Look(page_->beats.load(std::memory_order_acquire), now);
  const bool has_ended = WaitForEnd(0);
  // asked after its end: it says so before it ends
  if (page_->is_closed.load(std::memory_order_acquire)) return state_ = State::kClosed;
  if (has_ended || silence_ >= kLongestBeatSilence) Kill();
  return state_;
}

void HostWatch::Kill() noexcept {
  if (state_ == State::kClosed) return;
  state_ = State::kFailed;
  if (process_ < 0 || ::pidfd_send_signal(process_, SIGKILL, nullptr, 0) != 0) return;
  // its number is its own as long as it has not ended
  const int number = page_ != nullptr ? page_->process.load(std::memory_order_acquire) : 0;
  if (number > 0 && !WaitForEnd(0)) LetEnd(number);
}

bool HostWatch::WaitForEnd(int milliseconds) const noexcept {
  pollfd ended{process_, POLLIN, 0};
  return ::poll(&ended, 1, milliseconds) > 0;
}

}  // namespace trocar::device
