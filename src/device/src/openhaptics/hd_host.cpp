// SPDX-License-Identifier: Apache-2.0
#include "hd_host.h"

#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

#include "hd_devices.h"

namespace trocar::device {
namespace {

using core::ErrorCode;

// requests: "open", the library's file and the names of the devices on lines of their own; "start"; "stop"
constexpr std::string_view kOpen = "open\n", kStart = "start", kStop = "stop";
constexpr std::size_t kLongestRequest = 4096;
constexpr int kOpenTime = 15'000;   // for the library to open its devices [ms]
constexpr int kAnswerTime = 2'000;  // for the rest [ms]

struct Reply {
  std::int32_t code = 0;  // core::ErrorCode
  std::uint32_t count = 0;
  ForceLimits limits[ForceMailbox::kMaxDevices];
  char text[600] = {};
};
static_assert(std::is_trivially_copyable_v<Reply>);
// both ends are this program's, from one build; neither destroys what the other may still read
static_assert(std::is_trivially_destructible_v<ForceMailbox>);

core::Error HostError(const std::string& what) {
  return {ErrorCode::kDeviceLost,
          "openhaptics: " + what + "; switch the device off and on, and check it with the maker's program"};
}

core::Result<Reply> Ask(int socket, std::string_view request, int milliseconds) {
  if (::send(socket, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()))
    return HostError("the process of the maker's library is gone");
  pollfd waited{socket, POLLIN, 0};
  if (::poll(&waited, 1, milliseconds) != 1) return HostError("the maker's library does not answer");
  Reply reply;
  if (::recv(socket, &reply, sizeof reply, 0) != static_cast<ssize_t>(sizeof reply))
    return HostError("the process of the maker's library is gone");
  reply.text[sizeof reply.text - 1] = 0;
  if (reply.code != 0) return core::Error{static_cast<ErrorCode>(reply.code), reply.text};
  if (reply.count > ForceMailbox::kMaxDevices) return HostError("the maker's library answers nonsense");
  return reply;
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

}  // namespace

core::Status HdHost::Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) {
  std::string request(kOpen);
  request += settings.hd_file + "\n";
  for (const std::string& name : settings.names) {
    if (name.find('\n') != std::string::npos || name.empty())
      return core::Error{ErrorCode::kDeviceSettings, "openhaptics: a device's name is one line"};
    request += name + "\n";
  }
  if (request.size() > kLongestRequest)
    return core::Error{ErrorCode::kDeviceSettings, "openhaptics: the devices' names are too long"};
  auto started =
      Companion::Start(settings.host, "--openhaptics", sizeof(ForceMailbox), ErrorCode::kDeviceUnsupported,
                       "OpenHaptics runs in the supervisor's program: reinstall Trocar, or build "
                       "the target trocar-supervisor");
  if (!started) return started.error();
  companion_.emplace(std::move(*started));
  new (companion_->Page()) ForceMailbox;
  const core::Result<Reply> reply = Ask(companion_->Socket(), request, kOpenTime);
  if (!reply) {
    Close();
    return reply.error();
  }
  limits.assign(reply->limits, reply->limits + reply->count);
  return {};
}

core::Status HdHost::Start() {
  const core::Result<Reply> reply = Ask(companion_->Socket(), kStart, kAnswerTime);
  return reply ? core::Status{} : core::Status(reply.error());
}

void HdHost::Stop() noexcept {
  if (companion_) static_cast<void>(Ask(companion_->Socket(), kStop, kAnswerTime));
}

void HdHost::Close() noexcept {
  companion_.reset();
}

int RunOpenHapticsHost(int socket, int page) {
  // a terminal's signals to the group must not take the library away; the simulator's end is our end
  for (const int ignored : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) ::signal(ignored, SIG_IGN);
  void* memory = ::mmap(nullptr, sizeof(ForceMailbox), PROT_READ | PROT_WRITE, MAP_SHARED, page, 0);
  if (memory == MAP_FAILED) return 1;
  HdDevices devices(*static_cast<ForceMailbox*>(memory));
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
    } else {
      done = HostError("a request that is none");
    }
    const Reply reply = MakeReply(done, limits);
    if (::send(socket, &reply, sizeof reply, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof reply)) break;
  }
  devices.Close();
  return 0;
}

}  // namespace trocar::device
