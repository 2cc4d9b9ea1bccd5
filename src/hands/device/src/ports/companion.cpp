// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/companion.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "trocar/device/ports.h"
#include "trocar/host/program.h"

// glibc 2.36 declares these for C only
extern "C" {
#include <sys/pidfd.h>
}

extern char** environ;

namespace trocar::device {

std::filesystem::path Companion::Find(const char* name) {
  return host::FindCompanionProgram(name);
}

base::Result<Companion> Companion::Start(const std::filesystem::path& program, const char* option,
                                         std::size_t bytes, base::ErrorCode code, const std::string& remedy) {
  const auto fail = [&](const std::string& what) { return base::Error{code, what + "; " + remedy}; };
  Companion companion;
  // high numbers, so that moving them to 3 and 4 in the child closes neither
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return fail("no socket pair");
  companion.socket_ = ends[0];
  const int their_end = ::fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
  ::close(ends[1]);
  companion.page_file_ = ::memfd_create(program.filename().c_str(), MFD_CLOEXEC);
  const int their_page = ::fcntl(companion.page_file_, F_DUPFD_CLOEXEC, 10);
  const auto close_theirs = [&] { ::close(their_end), ::close(their_page); };
  void* mapped = MAP_FAILED;
  if (their_end >= 0 && their_page >= 0 && ::ftruncate(their_page, static_cast<off_t>(bytes)) == 0)
    mapped = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, their_page, 0);
  if (mapped == MAP_FAILED) {
    close_theirs();
    return fail("no shared memory");
  }
  companion.page_ = mapped;
  companion.bytes_ = bytes;

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_adddup2(&actions, their_end, kSocket);
  ::posix_spawn_file_actions_adddup2(&actions, their_page, kPage);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  const std::string name = program.string();
  char* const arguments[] = {const_cast<char*>(name.c_str()), const_cast<char*>(option), nullptr};
  const int failed =
      ::posix_spawn(&companion.process_, name.c_str(), &actions, &attributes, arguments, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  close_theirs();
  if (failed != 0) {
    companion.process_ = -1;
    return fail("cannot start " + name + " (" + std::strerror(failed) + ")");
  }
  companion.handle_ = ::pidfd_open(companion.process_, 0);
  if (companion.handle_ < 0)
    return fail("no handle of a process (" + std::string(std::strerror(errno)) + ")");
  return companion;
}

Companion::Companion(Companion&& other) noexcept {
  *this = std::move(other);
}

Companion& Companion::operator=(Companion&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(socket_, other.socket_);
  std::swap(page_file_, other.page_file_);
  std::swap(handle_, other.handle_);
  std::swap(page_, other.page_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

Companion::~Companion() {
  End();
}

void Companion::Kill() noexcept {
  // not waited for yet, so the number is still its own
  if (process_ > 0) ::kill(process_, SIGKILL);
}

void Companion::End() noexcept {
  for (const int file : {socket_, page_file_, handle_}) {
    if (file >= 0) ::close(file);
  }
  if (page_ != nullptr) ::munmap(page_, bytes_);
  if (process_ <= 0) return;
  constexpr double kLook = 0.001;  // [s]
  for (double waited = 0; waited < kPatience; waited += kLook) {
    if (::waitpid(process_, nullptr, WNOHANG) != 0) return;
    SystemClock().Sleep(kLook);
  }
  Kill();
  // one that hangs in a driver of the system cannot be waited for
  for (double waited = 0; waited < kPatience; waited += kLook) {
    if (::waitpid(process_, nullptr, WNOHANG) != 0) return;
    SystemClock().Sleep(kLook);
  }
}

}  // namespace trocar::device
