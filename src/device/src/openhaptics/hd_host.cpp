// SPDX-License-Identifier: Apache-2.0
#include "hd_host.h"

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <new>
#include <thread>
#include <utility>

#include "hd_devices.h"
#include "trocar/core/beat_watch.h"
#include "trocar/core/clock.h"
#include "trocar/core/real_time.h"

namespace trocar::device {
namespace {

using core::ErrorCode;

using hd_host::kLongestRequest;
using hd_host::kOpen;
using hd_host::kRescue;
using hd_host::kStart;
using hd_host::kStop;
using hd_host::Reply;

constexpr int kOpenTime = 15'000;   // for the library to open its devices [ms]
constexpr int kAnswerTime = 2'000;  // for the rest [ms]

core::Error HostError(const std::string& what) {
  return {ErrorCode::kDeviceLost,
          "openhaptics: " + what + "; switch the device off and on, and check it with the maker's program"};
}

core::Result<Reply> TakeReply(int socket, int milliseconds) {
  pollfd waited{socket, POLLIN, 0};
  if (::poll(&waited, 1, milliseconds) != 1) return HostError("the maker's library does not answer");
  Reply reply;
  if (::recv(socket, &reply, sizeof reply, 0) != static_cast<ssize_t>(sizeof reply))
    return HostError("the process of the maker's library is gone");
  if (reply.code != 0) {
    const std::string text(reply.text, ::strnlen(reply.text, sizeof reply.text));
    return core::Error{static_cast<ErrorCode>(reply.code), text};
  }
  if (reply.count > ForceMailbox::kMaxDevices) return HostError("the maker's library answers nonsense");
  return reply;
}

core::Result<Reply> Ask(int socket, std::string_view request, int milliseconds) {
  if (::send(socket, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()))
    return HostError("the process of the maker's library is gone");
  return TakeReply(socket, milliseconds);
}

Reply MakeReply(const core::Status& status, const std::vector<ForceLimits>& limits) {
  Reply reply;
  if (!status) {
    reply.code = static_cast<std::int32_t>(status.error().code);
    status.error().message.copy(reply.text, sizeof reply.text - 1);
    return reply;
  }
  reply.count = static_cast<std::uint32_t>(std::min(limits.size(), std::size(reply.limits)));
  std::copy_n(limits.begin(), reply.count, reply.limits);
  return reply;
}

OpenHapticsSettings ReadSettings(std::string_view lines) {
  OpenHapticsSettings settings;
  settings.names.clear();
  for (bool is_first = true; !lines.empty(); is_first = false) {
    const std::string line(lines.substr(0, lines.find('\n')));
    lines.remove_prefix(std::min(line.size() + 1, lines.size()));
    is_first ? settings.hd_file = line : settings.names.emplace_back(line);
  }
  return settings;
}

/// Above the haptic loop, below the supervisor. Threads that are started afterwards inherit it.
constexpr int kPriorityAboveLowest = 15;

void GoFirst() noexcept {
  static_cast<void>(core::AskForRealTime(core::RealTimePolicy::kFirstInFirstOut, kPriorityAboveLowest));
}

core::Result<std::string> FormatOpen(const OpenHapticsSettings& settings) {
  std::string request = settings.hd_file + "\n";
  for (const std::string& name : settings.names) {
    if (name.find('\n') != std::string::npos || name.empty())
      return core::Error{ErrorCode::kDeviceSettings, "openhaptics: a device's name is one line"};
    request += name + "\n";
  }
  if (request.size() + kRescue.size() > kLongestRequest)
    return core::Error{ErrorCode::kDeviceSettings, "openhaptics: the devices' names are too long"};
  return request;
}

}  // namespace

HdHost::~HdHost() {
  Close();
}

core::Result<Companion> HdHost::StartProcess(const OpenHapticsSettings& settings) {
  auto started =
      Companion::Start(settings.host, "--openhaptics", sizeof(HdHostPage), ErrorCode::kDeviceUnsupported,
                       "OpenHaptics runs in the supervisor's program: reinstall Trocar, or build "
                       "the target trocar-supervisor");
  if (started) new (started->Page()) HdHostPage;
  return started;
}

/// The spare has opened the devices after a failure: it is the one from now on.
bool HdHost::TakeRescued(std::vector<ForceLimits>& limits) {
  if (!is_rescued_) return false;
  is_rescued_ = false;
  const core::Result<Reply> reply = TakeReply(spare_->Socket(), kOpenTime);
  if (!reply) {
    spare_->Kill();
    spare_.reset();
    return false;
  }
  limits.assign(reply->limits, reply->limits + reply->count);
  active_ = std::move(spare_);
  spare_.reset();
  return true;
}

core::Status HdHost::Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) {
  core::Result<std::string> request = FormatOpen(settings);
  if (!request) return request.error();
  request_ = std::move(*request);
  if (!TakeRescued(limits)) {
    auto started = StartProcess(settings);
    if (!started) return started.error();
    active_.emplace(std::move(*started));
    const core::Result<Reply> reply = Ask(active_->Socket(), std::string(kOpen) + request_, kOpenTime);
    if (!reply) {
      Close();
      return reply.error();
    }
    limits.assign(reply->limits, reply->limits + reply->count);
  }
  // without a spare the devices are opened again as any lost one
  if (auto spare = StartProcess(settings)) spare_.emplace(std::move(*spare));
  is_ending_ = has_failed_ = false;
  if (kIsHostWatched) watch_ = std::thread([this] { Watch(); });
  return {};
}

/// Of a thread of its own, from the open devices to their end or the process's failure.
void HdHost::Watch() noexcept {
  GoFirst();
  const HdHostPage& page = Page(*active_);
  core::BeatWatch watch(kLongestBeatLook);
  watch.Forget(core::NowNanoseconds());
  while (!is_ending_.load(std::memory_order_acquire)) {
    // the socket closes with the process, however it ends
    pollfd watched{active_->Socket(), POLLRDHUP, 0};
    const timespec look{0, kBeatLook};
    const bool has_died = ::ppoll(&watched, 1, &look, nullptr) > 0;
    const std::uint64_t beats = page.beats.load(std::memory_order_acquire);
    const std::int64_t silence = watch.Look(beats, core::NowNanoseconds());
    if (!has_died && silence < kLongestBeatSilence) continue;
    active_->Kill();
    has_failed_.store(true, std::memory_order_release);
    if (spare_) {
      const std::string request = std::string(kRescue) + request_;
      is_rescued_ = ::send(spare_->Socket(), request.data(), request.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
                    static_cast<ssize_t>(request.size());
    }
    return;
  }
}

void HdHost::EndWatch() noexcept {
  is_ending_.store(true, std::memory_order_release);
  if (watch_.joinable()) watch_.join();
}

core::Status HdHost::Start() {
  const core::Result<Reply> reply = Ask(active_->Socket(), kStart, kAnswerTime);
  return reply ? core::Status{} : core::Status(reply.error());
}

void HdHost::Stop() noexcept {
  if (active_ && !HasFailed()) static_cast<void>(Ask(active_->Socket(), kStop, kAnswerTime));
}

void HdHost::Close() noexcept {
  EndWatch();
  if (HasFailed() && active_) active_->Kill();
  active_.reset();
  // what has taken over keeps the devices until they are wanted again
  if (!is_rescued_) spare_.reset();
}

namespace {

/// Looks every millisecond whether the library still calls; when it does not, its process ends, and with it every hold on
/// the device. The simulator sees that at once, even where it is the simulator that has died.
void GuardLibrary(HdDevices& devices, HdHostPage& page, const std::atomic<bool>& is_ending) noexcept {
  core::BeatWatch watch(kLongestBeatLook);
  while (!is_ending.load(std::memory_order_acquire)) {
    const timespec look{0, kBeatLook};
    ::nanosleep(&look, nullptr);
    const std::int64_t now = core::NowNanoseconds();
    if (!devices.IsCalled()) watch.Forget(now);
    if (kIsHostWatched && watch.Look(devices.CountCalls(), now) >= kLongestCallSilence) {
      // a library that is well but for its scheduler takes a zero; should it hang, the simulator's watch ends us
      devices.PushZero();
      ::_exit(hd_host::kLibraryStands);
    }
    page.beats.fetch_add(1, std::memory_order_release);
  }
}

/// In place of a process that failed: zero to the devices, which then wait for somebody to ask for them.
core::Status TakeOver(HdDevices& devices) {
  if (core::Status started = devices.Start(); !started) return started;
  devices.Stop();
  return {};
}

}  // namespace

int RunOpenHapticsHost(int socket, int page) {
  // a terminal's signals to the group must not take the library away; the simulator's end is our end
  for (const int ignored : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) ::signal(ignored, SIG_IGN);
  // a crash has to end the process at once, not after a large file has been written about it
  static_cast<void>(::prctl(PR_SET_DUMPABLE, 0UL));
  void* memory = ::mmap(nullptr, sizeof(HdHostPage), PROT_READ | PROT_WRITE, MAP_SHARED, page, 0);
  if (memory == MAP_FAILED) return 1;
  auto& shared = *static_cast<HdHostPage*>(memory);
  GoFirst();
  HdDevices devices(shared.mailbox);
  // watched from the moment the devices are open, not from the guard's first look
  shared.beats.store(1, std::memory_order_release);
  std::atomic<bool> is_ending{false};
  std::thread guard([&] { GuardLibrary(devices, shared, is_ending); });
  std::vector<ForceLimits> limits;
  char bytes[kLongestRequest];
  for (;;) {
    // forces end by themselves meanwhile: the library's thread takes none that is older than kForceLife
    const ssize_t size = ::recv(socket, bytes, sizeof bytes, 0);
    if (size <= 0) break;
    const std::string_view request(bytes, static_cast<std::size_t>(size));
    core::Status done;
    if (request == kStart) {
      done = limits.empty() ? core::Status(HostError("nothing is open")) : devices.Start();
    } else if (request == kStop) {
      devices.Stop();
    } else if (request.starts_with(kOpen) && limits.empty()) {
      done = devices.Open(ReadSettings(request.substr(kOpen.size())), limits);
    } else if (request.starts_with(kRescue) && limits.empty()) {
      done = devices.Open(ReadSettings(request.substr(kRescue.size())), limits);
      if (done) done = TakeOver(devices);
    } else {
      done = HostError("a request that is none");
    }
    const Reply reply = MakeReply(done, limits);
    if (::send(socket, &reply, sizeof reply, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof reply)) break;
  }
  devices.Close();
  is_ending.store(true, std::memory_order_release);
  guard.join();
  return 0;
}

}  // namespace trocar::device
