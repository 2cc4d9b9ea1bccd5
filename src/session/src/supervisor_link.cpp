// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/supervisor_link.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "supervisor_protocol.h"

extern char** environ;

namespace trocar::session {
namespace {

constexpr double kLongestOwnSilence = 0.050;  // of the supervisor [s]

core::Error Fail(const std::string& what) {
  return {core::ErrorCode::kHapticSupervisor,
          what +
              "; without the supervisor there is no force: reinstall Trocar, or "
              "build the target trocar-supervisor"};
}

}  // namespace

struct SupervisorLink::Content {
  pid_t process = -1;
  int socket = -1;
  SupervisorPage* page = nullptr;
  std::uint64_t seen_beats = 0, seen_trips = 0;
  double last_seen = 0;  // [s]

  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  ~Content() {
    if (socket >= 0) ::close(socket);
    if (page != nullptr) ::munmap(page, sizeof(SupervisorPage));
    if (process > 0) ::waitpid(process, nullptr, 0);
  }
};

std::filesystem::path SupervisorLink::FindProgram() {
  std::error_code failure;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", failure).parent_path();
  const auto installed = folder.parent_path() / "libexec/trocar/trocar-supervisor";
  return std::filesystem::exists(installed, failure) ? installed : folder / "trocar-supervisor";
}

core::Result<SupervisorLink> SupervisorLink::Start(const std::filesystem::path& program) {
  auto content = std::make_unique<Content>();
  // high numbers, so that moving them to 3 and 4 in the child closes neither
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return Fail("no socket pair");
  content->socket = ends[0];
  const int their_end = ::fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
  ::close(ends[1]);
  const int memory = ::memfd_create("trocar-supervisor", MFD_CLOEXEC);
  const int their_page = ::fcntl(memory, F_DUPFD_CLOEXEC, 10);
  ::close(memory);
  const auto close_theirs = [&] { ::close(their_end), ::close(their_page); };
  void* mapped = MAP_FAILED;
  if (their_end >= 0 && their_page >= 0 && ::ftruncate(their_page, sizeof(SupervisorPage)) == 0)
    mapped = ::mmap(nullptr, sizeof(SupervisorPage), PROT_READ | PROT_WRITE, MAP_SHARED, their_page, 0);
  if (mapped == MAP_FAILED) {
    close_theirs();
    return Fail("no shared memory");
  }
  content->page = static_cast<SupervisorPage*>(mapped);

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_adddup2(&actions, their_end, kSupervisorSocket);
  ::posix_spawn_file_actions_adddup2(&actions, their_page, kSupervisorPage);
  // its own session: Ctrl-C and Ctrl-Z of our terminal do not reach it
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  const std::string name = program.string();
  const std::string option = "--watch";
  char* const arguments[] = {const_cast<char*>(name.c_str()), const_cast<char*>(option.c_str()), nullptr};
  const int failed =
      ::posix_spawn(&content->process, name.c_str(), &actions, &attributes, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  close_theirs();
  if (failed != 0) {
    content->process = -1;
    return Fail("cannot start " + name + " (" + std::strerror(failed) + ")");
  }
  return SupervisorLink(std::move(content));
}

SupervisorLink::SupervisorLink(std::unique_ptr<Content> content) : content_(std::move(content)) {}
SupervisorLink::SupervisorLink(SupervisorLink&&) noexcept = default;
SupervisorLink& SupervisorLink::operator=(SupervisorLink&&) noexcept = default;
SupervisorLink::~SupervisorLink() = default;

core::Status SupervisorLink::AddWire(const device::SupervisedWire& wire) {
  if (wire.file < 0) return {};
  WireMessage message;
  message.size = static_cast<std::uint32_t>(wire.size);
  message.is_closed_after = wire.is_closed_after ? 1 : 0;
  std::memcpy(message.zero_frame, wire.zero_frame.data(), wire.size);
  iovec part{&message, sizeof message};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
  msghdr header{};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  header.msg_control = control;
  header.msg_controllen = sizeof control;
  cmsghdr* carried = CMSG_FIRSTHDR(&header);
  carried->cmsg_level = SOL_SOCKET;
  carried->cmsg_type = SCM_RIGHTS;
  carried->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(carried), &wire.file, sizeof(int));
  if (::sendmsg(content_->socket, &header, MSG_NOSIGNAL) != static_cast<ssize_t>(sizeof message))
    return Fail(std::string("the supervisor takes no wire (") + std::strerror(errno) + ")");
  return {};
}

void SupervisorLink::ForgetWires() noexcept {
  const WireMessage message;
  [[maybe_unused]] const ssize_t sent = ::send(content_->socket, &message, sizeof message, MSG_NOSIGNAL);
}

void SupervisorLink::Beat() noexcept {
  content_->page->beats.fetch_add(1, std::memory_order_release);
}

bool SupervisorLink::IsAlive(double now) noexcept {
  Content& c = *content_;
  const std::uint64_t beats = c.page->supervisor_beats.load(std::memory_order_relaxed);
  if (beats != c.seen_beats) {
    c.seen_beats = beats;
    c.last_seen = now;
  }
  return c.seen_beats > 0 && now - c.last_seen <= kLongestOwnSilence;
}

bool SupervisorLink::TakeTrip() noexcept {
  const std::uint64_t trips = content_->page->trips.load(std::memory_order_acquire);
  const bool is_new = trips != content_->seen_trips;
  content_->seen_trips = trips;
  return is_new;
}

}  // namespace trocar::session
