// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>

#include "supervisor_protocol.h"
#include "supervisor_watch.h"
#include "trocar/device/file_messages.h"
#include "trocar/device/library_guard.h"
#include "trocar/host/clock.h"
#include "trocar/host/real_time.h"
#include "trocar/session/supervisor_link.h"

namespace trocar::session {
namespace {

/// Above the haptic loop and the process of a maker's library.
constexpr int kPriorityAboveLowest = 20;
constexpr int kLastWords = 3;  // zero frames after the other end has closed
constexpr timespec kBetweenLastWords{0, 2'000'000};
/// Between two looks at the processes of a maker's library [ns].
constexpr std::int64_t kLibraryLook = 1'000'000;

struct Wire {
  int file = -1;
  WireMessage message;
};

struct Supervisor {
  std::array<Wire, kMaxWires> room;
  std::size_t wire_count = 0;
  device::LibraryGuard library;

  std::span<const Wire> Wires() const noexcept { return std::span(room).first(wire_count); }

  void SendZero() noexcept {
    for (const Wire& wire : Wires()) {
      // non-blocking: what does not go now goes with the next
      [[maybe_unused]] const ssize_t sent = ::write(wire.file, wire.message.zero_frame, wire.message.size);
    }
  }

  /// Takes what the other end sent. Returns false once it has closed.
  bool Receive(int socket) noexcept {
    for (;;) {
      alignas(WireMessage) std::array<char, kLongestMessage> bytes;
      const device::FileMessage got = device::ReceiveFiles(socket, bytes, MSG_DONTWAIT);
      if (got.size < 0) return errno == EAGAIN;
      if (got.size == 0) return false;
      const std::span files(got.files, got.file_count);
      if (files.empty()) {
        for (const Wire& wire : Wires()) ::close(wire.file);
        wire_count = 0;
        library.Forget();
      } else if (files.size() == 1) {
        TakeWire(files[0], std::span(bytes).first(static_cast<std::size_t>(got.size)));
      } else {
        if (files.size() % 2 == 0) library.Take({bytes.data(), static_cast<std::size_t>(got.size)}, files);
        device::CloseFiles(files);
      }
    }
  }
  void TakeWire(int file, std::span<const char> bytes) noexcept {
    WireMessage message;
    if (bytes.size() == sizeof message) std::memcpy(&message, bytes.data(), sizeof message);
    if (bytes.size() != sizeof message || message.size > device::SupervisedWire::kMaxBytes ||
        wire_count == room.size()) {
      ::close(file);
      return;
    }
    room[wire_count++] = {file, message};
  }

  void SayLastWords() noexcept {
    for (int i = 0; i < kLastWords; ++i) {
      SendZero();
      ::nanosleep(&kBetweenLastWords, nullptr);
    }
    for (const Wire& wire : Wires()) {
      if (wire.message.is_closed_after != 0) ::shutdown(wire.file, SHUT_RDWR);
    }
  }
};

/// Before everybody else on the processor, and never waiting for memory, as far as the system permits; what it refuses is
/// done without.
void GoFirst() noexcept {
  static_cast<void>(::mlockall(MCL_CURRENT | MCL_FUTURE));
  static_cast<void>(host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, kPriorityAboveLowest));
  // without real time the timer's own slack, 50 us by default, is ours to give up
  static_cast<void>(::prctl(PR_SET_TIMERSLACK, 1UL));
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
  SupervisorWatch watch;
  for (;;) {
    pollfd watched{socket, POLLIN, 0};
    std::int64_t wait = watch.CalcSleep(host::NowNanoseconds());
    if (supervisor.library.IsOn()) wait = std::min(wait, kLibraryLook);
    const timespec sleep{0, static_cast<long>(wait)};
    ::ppoll(&watched, 1, &sleep, nullptr);
    if (watched.revents != 0 && !supervisor.Receive(socket)) {
      supervisor.SayLastWords();
      supervisor.library.SeeOut();
      return 0;
    }
    shared.supervisor_beats.fetch_add(1, std::memory_order_relaxed);
    const bool is_silent = watch.Look(shared.beats.load(std::memory_order_acquire), host::NowNanoseconds());
    // told first: a simulator that wakes now knows that its force has been taken away
    shared.trips.store(watch.CountTrips(), std::memory_order_release);
    if (is_silent) supervisor.SendZero();
    supervisor.library.Look(host::NowNanoseconds());
  }
}

}  // namespace trocar::session
