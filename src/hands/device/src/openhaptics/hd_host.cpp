// SPDX-License-Identifier: Apache-2.0
#include "hd_host.h"

#include <poll.h>
#include <sys/socket.h>
#include <time.h>

#include <cstring>
#include <new>
#include <thread>
#include <utility>

#include "trocar/device/file_messages.h"
#include "trocar/host/clock.h"
#include "trocar/host/real_time.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

using hd_host::kLongestRequest;
using hd_host::kOpen;
using hd_host::kStart;
using hd_host::kStop;
using hd_host::kWatch;
using hd_host::Reply;

constexpr int kOpenTime = 15'000;   // for a program to start and the library to open its devices [ms]
constexpr int kAnswerTime = 2'000;  // for the rest [ms]
constexpr std::int64_t kMillisecond = 1'000'000;

base::Result<Reply> TakeReply(int socket, int milliseconds) {
  pollfd waited{socket, POLLIN, 0};
  if (::poll(&waited, 1, milliseconds) != 1) return HostError("the maker's library does not answer");
  Reply reply;
  if (::recv(socket, &reply, sizeof reply, 0) != static_cast<ssize_t>(sizeof reply))
    return HostError("the process of the maker's library is gone");
  if (reply.code != 0) {
    const std::string text(reply.text, ::strnlen(reply.text, sizeof reply.text));
    return base::Error{static_cast<ErrorCode>(reply.code), text};
  }
  if (reply.count > ForceMailbox::kMaxDevices) return HostError("the maker's library answers nonsense");
  return reply;
}

base::Result<Reply> Ask(int socket, std::string_view request, int milliseconds) {
  if (::send(socket, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()))
    return HostError("the process of the maker's library is gone");
  return TakeReply(socket, milliseconds);
}

base::Result<std::string> FormatOpen(const OpenHapticsSettings& settings) {
  std::string request = settings.hd_file + "\n";
  for (const std::string& name : settings.names) {
    if (name.find('\n') != std::string::npos || name.empty())
      return base::Error{ErrorCode::kDeviceSettings, "openhaptics: a device's name is one line"};
    request += name + "\n";
  }
  if (request.size() + kWatch.size() > kLongestRequest)
    return base::Error{ErrorCode::kDeviceSettings, "openhaptics: the devices' names are too long"};
  return request;
}

}  // namespace

base::Error HostError(const std::string& what) {
  return {ErrorCode::kDeviceLost,
          "openhaptics: " + what + "; switch the device off and on, and check it with the maker's program"};
}

void GoFirst() noexcept {
  /// Above the haptic loop, below the supervisor.
  constexpr int kPriorityAboveLowest = 15;
  static_cast<void>(host::AskForRealTime(host::RealTimePolicy::kFirstInFirstOut, kPriorityAboveLowest));
}

HdHost::~HdHost() {
  Close();
}

base::Result<Companion> HdHost::StartProcess(const OpenHapticsSettings& settings) {
  auto started =
      Companion::Start(settings.host, "--openhaptics", sizeof(HdHostPage), ErrorCode::kDeviceUnsupported,
                       "OpenHaptics runs in the supervisor's program: reinstall Trocar, or build "
                       "the target trocar-supervisor");
  if (started) new (started->Page()) HdHostPage;
  return started;
}

/// The spare has opened the devices after a failure: it is the one from now on. One that fails meanwhile is not waited for.
bool HdHost::TakeRescued(std::vector<ForceLimits>& limits) {
  if (!is_rescued_) return false;
  is_rescued_ = false;
  const std::int64_t begin = host::NowNanoseconds();
  pollfd answered{spare_->Socket(), POLLIN, 0};
  for (std::int64_t now = begin; now - begin < kOpenTime * kMillisecond; now = host::NowNanoseconds()) {
    if (::poll(&answered, 1, 1) > 0 || spare_watch_->Look(now) != HostWatch::State::kRunning) break;
  }
  const base::Result<Reply> reply = TakeReply(spare_->Socket(), 0);
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

base::Status HdHost::Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) {
  base::Result<std::string> request = FormatOpen(settings);
  if (!request) return request.error();
  request_ = std::move(*request);
  if (!TakeRescued(limits)) {
    auto started = StartProcess(settings);
    if (!started) return started.error();
    active_.emplace(std::move(*started));
    const base::Result<Reply> reply = Ask(active_->Socket(), std::string(kOpen) + request_, kOpenTime);
    if (!reply) {
      Close();
      return reply.error();
    }
    limits.assign(reply->limits, reply->limits + reply->count);
  }
  StartSpare(settings);
  is_ending_ = has_failed_ = false;
  if (kIsHostWatched) watch_ = std::thread([this] { Watch(); });
  return {};
}

/// A process that has loaded nothing yet and watches the one that has. Without it the devices are opened again as any lost ones.
void HdHost::StartSpare(const OpenHapticsSettings& settings) {
  auto started = StartProcess(settings);
  if (!started) return;
  const int files[] = {active_->PageFile(), active_->Handle()};
  const bool has_gone = SendFiles(started->Socket(), std::string(kWatch) + request_, files);
  if (has_gone && TakeReply(started->Socket(), kOpenTime)) {
    spare_.emplace(std::move(*started));
  } else {
    started->Kill();
  }
}

/// Of a thread of its own, from the open devices to their end or the process's failure.
void HdHost::Watch() noexcept {
  GoFirst();
  HostWatch active(active_->PageFile(), active_->Handle());
  if (spare_) spare_watch_.emplace(spare_->PageFile(), spare_->Handle());
  while (!is_ending_.load(std::memory_order_acquire)) {
    pollfd watched{active.Process(), POLLIN, 0};
    const timespec look{0, kBeatLook};
    ::ppoll(&watched, 1, &look, nullptr);
    const std::int64_t now = host::NowNanoseconds();
    const bool has_spare = spare_ && spare_watch_->Look(now) == HostWatch::State::kRunning &&
                           spare_watch_->Silence() < kLongestSpareSilence;
    const HostWatch::State state = active.Look(now);
    if (state == HostWatch::State::kRunning) continue;
    // the spare sees it, too, and takes over by itself
    is_rescued_ = has_spare && state == HostWatch::State::kFailed;
    has_failed_.store(true, std::memory_order_release);
    return;
  }
}

SupervisedLibrary HdHost::Supervised() const {
  SupervisedLibrary library;
  if (!active_) return library;
  library.request = request_;
  library.files = {active_->PageFile(), active_->Handle()};
  if (spare_) library.files.insert(library.files.end(), {spare_->PageFile(), spare_->Handle()});
  return library;
}

void HdHost::EndWatch() noexcept {
  is_ending_.store(true, std::memory_order_release);
  if (watch_.joinable()) watch_.join();
}

base::Status HdHost::Start() {
  const base::Result<Reply> reply = Ask(active_->Socket(), kStart, kAnswerTime);
  return reply ? base::Status{} : base::Status(reply.error());
}

void HdHost::Stop() noexcept {
  if (active_ && !HasFailed()) static_cast<void>(Ask(active_->Socket(), kStop, kAnswerTime));
}

void HdHost::Close() noexcept {
  EndWatch();
  if (HasFailed() && active_) active_->Kill();
  active_.reset();
  // what has taken over keeps the devices until they are wanted again
  if (is_rescued_) return;
  if (HasFailed() && spare_) spare_->Kill();
  spare_.reset();
}

}  // namespace trocar::device
