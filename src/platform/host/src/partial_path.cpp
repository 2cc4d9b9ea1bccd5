// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/partial_path.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <string>
#include <system_error>

namespace trocar::host {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPaths = 32;
constexpr std::size_t kLongestPath = 4096;
constexpr int kDeepest = 8;
/// Another thread may write on while its folder is emptied.
constexpr int kPasses = 20;

enum State { kFree, kChanging, kInUse };

/// A handler may not allocate or lock, so the paths lie in a table that never moves.
struct Entry {
  std::atomic<int> state{kFree};
  ::pid_t owner = 0;  // a child of fork() has the table, too, and nothing in it is its own
  std::array<char, kLongestPath> path{};
};
std::array<Entry, kMostPaths> table;

/// As the kernel lays an entry of a folder out.
struct KernelEntry {
  std::uint64_t inode;
  std::int64_t offset;
  unsigned short size;
  unsigned char type;
  char name[1];
};

bool IsDots(const char* name) noexcept {
  return std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0;
}

#if defined(__EMSCRIPTEN__)
// no signal ends a page, so that this need not be system calls alone
void RemoveTree(int /*folder*/, const char* name, int /*depth*/) noexcept {
  std::error_code ignored;
  fs::remove_all(name, ignored);
}
#else
/// rm -r with system calls alone. Links are removed, never followed.
void RemoveTree(int folder, const char* name, int depth) noexcept {
  if (::unlinkat(folder, name, 0) == 0 || errno != EISDIR || depth > kDeepest) return;
  const int inside = ::openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (inside < 0) return;
  for (int pass = 0; pass < kPasses; ++pass) {
    alignas(KernelEntry) char bytes[2048];
    long got = 0;
    ::lseek(inside, 0, SEEK_SET);
    while ((got = ::syscall(SYS_getdents64, inside, bytes, sizeof bytes)) > 0) {
      for (long at = 0; at < got;) {
        unsigned short size = 0;
        std::memcpy(&size, bytes + at + offsetof(KernelEntry, size), sizeof size);
        const char* const entry = bytes + at + offsetof(KernelEntry, name);
        if (!IsDots(entry)) RemoveTree(inside, entry, depth + 1);
        at += size;
      }
    }
    if (::unlinkat(folder, name, AT_REMOVEDIR) == 0 || errno != ENOTEMPTY) break;
  }
  ::close(inside);
}

#endif

void OnSignal(int signal) {
  RemovePartialPaths();
  // its own action, which ends the process, comes when this handler returns
  struct sigaction own {};
  own.sa_handler = SIG_DFL;
  ::sigaction(signal, &own, nullptr);
  ::raise(signal);
}

}  // namespace

PartialPath::PartialPath(const fs::path& target) {
  std::error_code ignored;
  fs::path name = target;
  if (!name.has_filename()) name = name.parent_path();
  path_ = name.string() + ".part" + std::to_string(::getpid());
  fs::remove_all(path_, ignored);
  const std::string absolute = fs::absolute(path_, ignored).string();
  if (absolute.size() >= kLongestPath) return;
  for (std::size_t i = 0; i < table.size() && entry_ < 0; ++i) {
    int expected = kFree;
    if (!table[i].state.compare_exchange_strong(expected, kChanging)) continue;
    table[i].owner = ::getpid();
    std::memcpy(table[i].path.data(), absolute.c_str(), absolute.size() + 1);
    table[i].state.store(kInUse);
    entry_ = static_cast<int>(i);
  }
}

PartialPath::~PartialPath() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (entry_ >= 0) table[static_cast<std::size_t>(entry_)].state.store(kFree);
}

void RemovePartialPaths() noexcept {
  const int kept = errno;
  for (Entry& entry : table) {
    if (entry.state.load() == kInUse && entry.owner == ::getpid()) RemoveTree(AT_FDCWD, entry.path.data(), 0);
  }
  errno = kept;
}

void RemovePartialPathsOnSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    if (::sigaction(signal, nullptr, &before) != 0 || before.sa_handler != SIG_DFL) continue;
    struct sigaction ours {};
    ours.sa_handler = OnSignal;
    ::sigemptyset(&ours.sa_mask);
    ::sigaction(signal, &ours, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace trocar::host
