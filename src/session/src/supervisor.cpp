// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "supervisor_protocol.h"
#include "trocar/core/clock.h"
#include "trocar/session/supervisor_link.h"

namespace trocar::session {
namespace {

constexpr std::int64_t kRound = 2'000'000;  // longest sleep, within which it shows that it lives [ns]
constexpr std::int64_t kNap = 100'000;      // shortest [ns]
constexpr std::int64_t kAgain = 4'000'000;  // between two zero frames [ns]
constexpr int kLastWords = 3;               // zero frames after the other end has closed
constexpr timespec kBetweenLastWords{0, 2'000'000};

struct Wire {
  int file = -1;
  WireMessage message;
};

struct Supervisor {
  Wire wires[kMaxWires];
  int wire_count = 0;

  void SendZero() noexcept {
    for (int i = 0; i < wire_count; ++i) {
      // non-blocking: what does not go now goes with the next
      [[maybe_unused]] const ssize_t sent =
          ::write(wires[i].file, wires[i].message.zero_frame, wires[i].message.size);
    }
  }

  /// Takes what the other end sent. Returns false once it has closed.
  bool Receive(int socket) noexcept {
    for (;;) {
      WireMessage message;
      iovec part{&message, sizeof message};
      alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))];
      msghdr header{};
      header.msg_iov = &part;
      header.msg_iovlen = 1;
      header.msg_control = control;
      header.msg_controllen = sizeof control;
      const ssize_t size = ::recvmsg(socket, &header, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
      if (size < 0) return errno == EAGAIN || errno == EINTR;
      if (size == 0) return false;
      const cmsghdr* carried = CMSG_FIRSTHDR(&header);
      if (carried == nullptr || carried->cmsg_type != SCM_RIGHTS) {
        while (wire_count > 0) ::close(wires[--wire_count].file);
        continue;
      }
      int file = -1;
      std::memcpy(&file, CMSG_DATA(carried), sizeof file);
      if (size != sizeof message || message.size > device::SupervisedWire::kMaxBytes ||
          wire_count == kMaxWires) {
        ::close(file);
        continue;
      }
      wires[wire_count++] = {file, message};
    }
  }

  void SayLastWords() noexcept {
    for (int i = 0; i < kLastWords; ++i) {
      SendZero();
      ::nanosleep(&kBetweenLastWords, nullptr);
    }
    for (int i = 0; i < wire_count; ++i) {
      if (wires[i].message.is_closed_after != 0) ::shutdown(wires[i].file, SHUT_RDWR);
    }
  }
};

/// Before everybody else on the processor, and never waiting for memory, as far as the system permits; what it refuses is
/// done without.
void GoFirst() noexcept {
  static_cast<void>(::mlockall(MCL_CURRENT | MCL_FUTURE));
  sched_param parameters{};
  parameters.sched_priority = sched_get_priority_min(SCHED_FIFO) + 20;
  if (::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0) return;
  // the timer's own slack, 50 us by default, is ours to give up
  static_cast<void>(::prctl(PR_SET_TIMERSLACK, 1UL));
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, -20));
}

/// Until `due` [ns], but no longer than a round: the wait of an answer that is in time costs no processor.
timespec CalcSleep(std::int64_t due, std::int64_t now) noexcept {
  return {0, static_cast<long>(std::clamp(due - now, kNap, kRound))};
}

}  // namespace

int RunSupervisor(int socket, int page) {
  // a terminal's signals to the group must not take the watch away; the simulator's end is our end
  for (const int ignored : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) ::signal(ignored, SIG_IGN);
  void* memory = ::mmap(nullptr, sizeof(SupervisorPage), PROT_READ | PROT_WRITE, MAP_SHARED, page, 0);
  if (memory == MAP_FAILED) return 1;
  auto& shared = *static_cast<SupervisorPage*>(memory);
  GoFirst();

  Supervisor supervisor;
  constexpr auto kSilence = static_cast<std::int64_t>(1e9 * SupervisorLink::kLongestSilence);
  std::uint64_t beats = 0;
  std::int64_t last_beat = 0, last_zero = 0;
  bool is_tripped = false;
  for (;;) {
    pollfd watched{socket, POLLIN, 0};
    const std::int64_t due = is_tripped ? last_zero + kAgain : last_beat + kSilence;
    const std::int64_t before = core::NowNanoseconds();
    const timespec sleep = CalcSleep(beats == 0 ? before + kRound : due, before);
    ::ppoll(&watched, 1, &sleep, nullptr);
    if ((watched.revents & (POLLIN | POLLHUP | POLLERR)) != 0 && !supervisor.Receive(socket)) {
      supervisor.SayLastWords();
      return 0;
    }
    shared.supervisor_beats.fetch_add(1, std::memory_order_relaxed);
    const std::int64_t now = core::NowNanoseconds();
    const std::uint64_t seen = shared.beats.load(std::memory_order_acquire);
    if (seen != beats) {
      beats = seen;
      last_beat = now;
      is_tripped = false;
    }
    if (beats == 0 || now - last_beat < kSilence) continue;
    if (!is_tripped) shared.trips.fetch_add(1, std::memory_order_release);
    if (!is_tripped || now - last_zero >= kAgain) {
      supervisor.SendZero();
      last_zero = now;
    }
    is_tripped = true;
  }
}

}  // namespace trocar::session
