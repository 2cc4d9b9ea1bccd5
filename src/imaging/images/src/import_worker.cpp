// SPDX-License-Identifier: Apache-2.0
#include "import_worker.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/clock.h"
#include "trocar/host/printable.h"
#include "trocar/host/program.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

/// Arguments of posix_spawn that must be destroyed.
struct SpawnSettings {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

}  // namespace

fs::path FindImportProgram() {
  return host::FindCompanionProgram("trocar-import");
}

base::Result<SampleBuffer> SampleBuffer::Make(std::uint64_t bytes) {
  const Error failed{ErrorCode::kImportOutOfMemory, "there is no memory for " + std::to_string(bytes >> 20) +
                                                        " MiB of samples; close other programs"};
  SampleBuffer buffer;
  buffer.descriptor_ = Descriptor(::memfd_create("trocar samples", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (buffer.Get() < 0 || ::ftruncate(buffer.Get(), static_cast<off_t>(bytes)) != 0) return failed;
  if (::fcntl(buffer.Get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) return failed;
  void* begin = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, buffer.Get(), 0);
  if (begin == MAP_FAILED) return failed;
  buffer.data_ = static_cast<std::byte*>(begin);
  buffer.bytes_ = bytes;
  return buffer;
}

SampleBuffer::SampleBuffer(SampleBuffer&& other) noexcept {
  *this = std::move(other);
}

SampleBuffer& SampleBuffer::operator=(SampleBuffer&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

SampleBuffer::~SampleBuffer() {
  if (data_ != nullptr) ::munmap(data_, bytes_);
}

base::Result<std::unique_ptr<ImportWorker>> ImportWorker::Start(const ImportLimits& limits) {
  const fs::path program = limits.program.empty() ? FindImportProgram() : limits.program;
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    return Error{ErrorCode::kImportProgramMissing, std::string("no socket for the image reader: ") +
                                                       std::strerror(errno) + "; close other programs"};
  Descriptor ours(ends[0]), theirs(ends[1]);

  SpawnSettings spawn;
  // the socket first: it may itself be one of 0 to 2 where this program was started without them
  posix_spawn_file_actions_adddup2(&spawn.actions, theirs.Get(), kImportSocket);
  posix_spawn_file_actions_addopen(&spawn.actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&spawn.actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  // libraries would print what they find in files, names of patients included
  posix_spawn_file_actions_addopen(&spawn.actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addclosefrom_np(&spawn.actions, kImportSocket + 1);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&spawn.attributes, &signals);
  sigfillset(&signals);
  posix_spawnattr_setsigdefault(&spawn.attributes, &signals);
  posix_spawnattr_setflags(&spawn.attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);

  std::string name = program.string(), memory = std::to_string(limits.reader_bytes);
  char* const arguments[] = {name.data(), memory.data(), nullptr};
  std::string locale = "LC_ALL=C", libraries;
  if (const char* path = std::getenv("LD_LIBRARY_PATH")) libraries = std::string("LD_LIBRARY_PATH=") + path;
  char* const environment[] = {locale.data(), libraries.empty() ? nullptr : libraries.data(), nullptr};
  pid_t process = -1;
  const int failure =
      ::posix_spawn(&process, program.c_str(), &spawn.actions, &spawn.attributes, arguments, environment);
  if (failure != 0) {
    return Error{ErrorCode::kImportProgramMissing, "the image reader " + host::Printable(name) +
                                                       " does not start (" + std::strerror(failure) +
                                                       "); build it too: ninja trocar-import"};
  }
  return std::unique_ptr<ImportWorker>(new ImportWorker(process, std::move(ours)));
}

ImportWorker::~ImportWorker() {
  if (IsAlive()) End();
}

bool ImportWorker::IsReady() const {
  pollfd state{socket_.Get(), 0, 0};
  return IsAlive() && ::poll(&state, 1, 0) == 0;
}

/// Ends the process for certain.
/// \return how it ended, as waitpid says it
int ImportWorker::End() {
  ::kill(process_, SIGKILL);
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

/// The reader hung up: why?
Error ImportWorker::FindCause() {
  // it may still be on its way out
  int status = 0;
  pid_t ended = 0;
  const host::Stopwatch stopwatch;
  while ((ended = ::waitpid(process_, &status, WNOHANG)) == 0 && stopwatch.Seconds() < 1.0) ::usleep(1000);
  if (ended == 0) {
    End();
    return {ErrorCode::kImportCrashed, "its reader answered nonsense"};
  }
  process_ = -1;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kExitOutOfMemory)
    return {ErrorCode::kImportOutOfMemory, "it needs more memory than its reader may have"};
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    return {ErrorCode::kImportProgramMissing,
            "the image reader cannot be run; build it again: ninja trocar-import"};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return {ErrorCode::kImportTimedOut, "its reader did not finish in time"};
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return {ErrorCode::kImportOutOfMemory, "its reader was killed, probably for want of memory"};
  if (WIFSIGNALED(status))
    return {ErrorCode::kImportCrashed,
            std::string("its reader crashed on it (") + ::strsignal(WTERMSIG(status)) + ")"};
  return {ErrorCode::kImportCrashed, "its reader gave up on it"};
}

base::Result<ImportReply> ImportWorker::Ask(const ImportRequest& request, std::span<const int> descriptors,
                                            double seconds) {
  TROCAR_ASSERT(IsAlive());
  if (!SendMessage(socket_.Get(), &request, sizeof(request), descriptors)) return FindCause();
  const host::Stopwatch stopwatch;
  for (;;) {
    const double left = seconds - stopwatch.Seconds();
    pollfd wait{socket_.Get(), POLLIN, 0};
    const int ready = left > 0 ? ::poll(&wait, 1, base::TruncateTo<int>(std::min(1e3 * left, 1e9)) + 1) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready > 0) break;
    End();
    return Error{ErrorCode::kImportTimedOut,
                 "its reader did not finish within " + std::to_string(base::CeilTo<int>(seconds)) + " s"};
  }
  ImportReply reply;
  if (!ReceiveMessage(socket_.Get(), &reply, sizeof(reply), {})) return FindCause();
  return reply;
}

}  // namespace trocar::images
