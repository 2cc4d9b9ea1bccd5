// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/library_guard.h"

#include <time.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

#include "hd_host_process.h"
#include "host_watch.h"
#include "trocar/host/clock.h"

namespace trocar::device {
namespace {

/// For the processes to give the devices back after the simulator's end; then they are ended [ns].
constexpr std::int64_t kPatience = 2'000'000'000;
constexpr timespec kLook{0, kBeatLook};

}  // namespace

struct LibraryGuard::Content {
  std::string request;
  std::vector<HostWatch> processes;  // the one that holds the devices, and its spare
  bool has_sent_zero = false;

  /// Looks at each. \return how many are in a state
  std::size_t Count(HostWatch::State state, std::int64_t now) noexcept {
    std::size_t count = 0;
    for (HostWatch& process : processes) count += process.Look(now) == state ? 1 : 0;
    return count;
  }
  /// In a process of its own: a library may hang or crash, and the wires need the supervisor.
  void SendZero() noexcept {
    has_sent_zero = true;
    if (::fork() != 0) return;
    ::signal(SIGCHLD, SIG_DFL);
    // a device opens for one process at a time
    for (const HostWatch& process : processes) static_cast<void>(process.WaitForEnd(kEndTime));
    // whoever waits for the supervisor's end sees it by its socket
    static_cast<void>(::close_range(STDERR_FILENO + 1, ~0U, 0));
    ::_exit(SendZeroOnce(request));
  }
};

LibraryGuard::LibraryGuard() : content_(std::make_unique<Content>()) {}
LibraryGuard::~LibraryGuard() = default;

void LibraryGuard::Take(std::string_view request, std::span<const int> files) {
  Forget();
  // nobody waits for the process that sends zero
  ::signal(SIGCHLD, SIG_IGN);
  content_->request = request;
  for (std::size_t i = 0; i + 1 < files.size(); i += 2)
    content_->processes.emplace_back(files[i], files[i + 1]);
}

void LibraryGuard::Forget() noexcept {
  content_->processes.clear();
  content_->has_sent_zero = false;
}

bool LibraryGuard::IsOn() const noexcept {
  return !content_->processes.empty() && !content_->has_sent_zero;
}

void LibraryGuard::Look(std::int64_t now) noexcept {
  if (!IsOn()) return;
  if (content_->Count(HostWatch::State::kFailed, now) == content_->processes.size()) content_->SendZero();
}

void LibraryGuard::SeeOut() noexcept {
  const std::int64_t begin = host::NowNanoseconds();
  for (std::int64_t now = begin; IsOn() && content_->Count(HostWatch::State::kRunning, now) > 0;
       now = host::NowNanoseconds()) {
    if (now - begin > kPatience) {
      for (HostWatch& process : content_->processes) process.Kill();
    }
    ::nanosleep(&kLook, nullptr);
  }
  Look(host::NowNanoseconds());
}

}  // namespace trocar::device
