// SPDX-License-Identifier: Apache-2.0
#include "hd_host_process.h"

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <optional>
#include <thread>

#include "hd_devices.h"
#include "hd_host.h"
#include "host_watch.h"
#include "trocar/device/file_messages.h"
#include "trocar/host/beat_watch.h"
#include "trocar/host/clock.h"

namespace trocar::device {
namespace {

using hd_host::Reply;

/// Between two attempts to open what another process may not have let go yet [ns], and how many there are.
constexpr timespec kBetweenAttempts{0, 2'000'000};
constexpr int kAttempts = 3;
/// For the process that holds the devices to give them back once the simulator is gone; then it is ended [ns].
constexpr std::int64_t kPatience = 1'000'000'000;

Reply MakeReply(const base::Status& status, const std::vector<ForceLimits>& limits) {
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

/// In place of a process that failed: zero to the devices, which then wait for somebody to ask for them.
base::Status TakeOver(HdDevices& devices, std::string_view request, std::vector<ForceLimits>& limits) {
  const OpenHapticsSettings settings = ReadSettings(request);
  base::Status done = devices.Open(settings, limits);
  for (int attempt = 1; attempt < kAttempts && !done; ++attempt) {
    ::nanosleep(&kBetweenAttempts, nullptr);
    done = devices.Open(settings, limits);
  }
  if (done) done = devices.Start();
  if (done) devices.Stop();
  return done;
}

/// Looks every millisecond whether the library still calls; when it does not, its process ends, and with it every hold on
/// the device. All that watch see that at once.
void GuardLibrary(HdDevices& devices, HdHostPage& page, const std::atomic<bool>& is_ending) noexcept {
  host::BeatWatch watch(kLongestBeatLook);
  while (!is_ending.load(std::memory_order_acquire)) {
    const timespec look{0, kBeatLook};
    ::nanosleep(&look, nullptr);
    const std::int64_t now = host::NowNanoseconds();
    if (!devices.IsCalled()) watch.Forget(now);
    if (kIsHostWatched && watch.Look(devices.CountCalls(), now) >= kLongestCallSilence) {
      // a library that is well but for its scheduler takes a zero; should it hang, the watches of others end us
      devices.PushZero();
      ::_exit(hd_host::kLibraryStands);
    }
    page.beats.fetch_add(1, std::memory_order_release);
  }
}

/// The process's main thread: does as it is asked, and watches the process whose spare it is.
class Host {
 public:
  Host(int socket, HdDevices& devices) : socket_(socket), devices_(devices) {}

  /// Until the simulator's end. \return whether the devices are at zero as far as this process is to answer for it
  bool Run() {
    while (Receive()) {
    }
    // who holds the devices for the simulator that is gone gives them back, or is replaced
    const std::int64_t begin = host::NowNanoseconds();
    while (watched_) {
      if (host::NowNanoseconds() - begin > kPatience) watched_->Kill();
      LookAtWatched();
      const timespec look{0, kBeatLook};
      ::nanosleep(&look, nullptr);
    }
    return is_at_zero_;
  }

 private:
  /// Waits for a request and answers it, or looks at the watched process. \return false once the other end has closed
  bool Receive() {
    pollfd asked{socket_, POLLIN, 0};
    const timespec look{0, kBeatLook};
    const int count = ::ppoll(&asked, 1, watched_ ? &look : nullptr, nullptr);
    LookAtWatched();
    if (count <= 0) return true;
    // forces end by themselves meanwhile: the library's thread takes none that is older than kForceLife
    char bytes[hd_host::kLongestRequest];
    const FileMessage got = ReceiveFiles(socket_, bytes, 0);
    if (got.size <= 0) return false;
    const std::span files(got.files, got.file_count);
    const base::Status done = Act(std::string_view(bytes, static_cast<std::size_t>(got.size)), files);
    CloseFiles(files);
    return Answer(done);
  }
  base::Status Act(std::string_view request, std::span<const int> files) {
    if (request == hd_host::kStart) return limits_.empty() ? HostError("nothing is open") : devices_.Start();
    if (request == hd_host::kStop) {
      devices_.Stop();
      return {};
    }
    if (request.starts_with(hd_host::kOpen) && limits_.empty())
      return devices_.Open(ReadSettings(request.substr(hd_host::kOpen.size())), limits_);
    if (request.starts_with(hd_host::kWatch) && limits_.empty() && files.size() == 2) {
      request_ = request.substr(hd_host::kWatch.size());
      watched_.emplace(files[0], files[1]);
      return {};
    }
    return HostError("a request that is none");
  }
  bool Answer(const base::Status& done) {
    const Reply reply = MakeReply(done, limits_);
    return ::send(socket_, &reply, sizeof reply, MSG_NOSIGNAL) == static_cast<ssize_t>(sizeof reply);
  }
  void LookAtWatched() {
    if (!watched_) return;
    const HostWatch::State state = watched_->Look(host::NowNanoseconds());
    if (state == HostWatch::State::kRunning) return;
    if (state == HostWatch::State::kFailed) {
      // a device opens for one process at a time
      static_cast<void>(watched_->WaitForEnd(kEndTime));
      const base::Status done = TakeOver(devices_, request_, limits_);
      is_at_zero_ = done.ok();
      Answer(done);
    }
    watched_.reset();
  }

  int socket_;
  HdDevices& devices_;
  std::vector<ForceLimits> limits_;  // of open devices
  std::string request_;              // that opens those of the watched process
  std::optional<HostWatch> watched_;
  bool is_at_zero_ = true;
};

}  // namespace

int SendZeroOnce(const std::string& request) noexcept {
  ForceMailbox mailbox;
  HdDevices devices(mailbox);
  std::vector<ForceLimits> limits;
  return TakeOver(devices, request, limits) ? 0 : 1;
}

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
  shared.process.store(::getpid(), std::memory_order_release);
  // watched from the moment the devices are open, not from the guard's first look
  shared.beats.store(1, std::memory_order_release);
  std::atomic<bool> is_ending{false};
  std::thread guard([&] { GuardLibrary(devices, shared, is_ending); });
  const bool is_at_zero = Host(socket, devices).Run();
  devices.Close();
  shared.is_closed.store(is_at_zero, std::memory_order_release);
  is_ending.store(true, std::memory_order_release);
  guard.join();
  return is_at_zero ? 0 : 1;
}

}  // namespace trocar::device
