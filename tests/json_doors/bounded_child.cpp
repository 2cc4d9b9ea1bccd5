// SPDX-License-Identifier: Apache-2.0
#include "bounded_child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <fstream>

namespace trocar::json_doors {
namespace {

constexpr std::size_t kMostMessage = 500;

/// In memory that both processes see.
struct SharedPiece {
  bool is_done, is_refused;
  double cpu_seconds;
  char message[kMostMessage + 1];
};

bool IsSanitized() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
  return true;
#endif
#endif
  return false;
}

double CpuSeconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::size_t AddressSpace() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void LimitChild(const ChildLimits& limits) {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  if (!IsSanitized()) {
    const rlim_t most = AddressSpace() + limits.memory_bytes;
    const rlimit memory{most, most};
    ::setrlimit(RLIMIT_AS, &memory);
  }
  ::alarm(limits.seconds);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void Work(std::size_t count, const std::function<std::string(std::size_t)>& piece,
                       SharedPiece* shared) {
  for (std::size_t i = 0; i < count; ++i) {
    const double begin = CpuSeconds();
    std::string message;
    try {
      message = piece(i);
    } catch (const std::exception& thrown) {
      std::snprintf(shared[i].message, sizeof shared[i].message, "threw %s", thrown.what());
      ::_exit(3);
    }
    shared[i].cpu_seconds = CpuSeconds() - begin;
    shared[i].is_refused = !message.empty();
    std::snprintf(shared[i].message, sizeof shared[i].message, "%s", message.c_str());
    shared[i].is_done = true;
  }
  ::_exit(0);
}

}  // namespace

ChildReport RunInChild(std::size_t count, const std::function<std::string(std::size_t)>& piece,
                       const ChildLimits& limits) {
  const std::size_t bytes = count * sizeof(SharedPiece);
  auto* shared = static_cast<SharedPiece*>(
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (shared == MAP_FAILED) return {{}, "no memory for its report"};
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    LimitChild(limits);
    Work(count, piece, shared);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ChildReport report;
  std::size_t done = 0;
  for (std::size_t i = 0; i < count; ++i) {
    report.pieces.push_back(
        {shared[i].is_done, shared[i].is_refused, shared[i].cpu_seconds, shared[i].message});
    done += shared[i].is_done ? 1 : 0;
  }
  if (WIFSIGNALED(status)) {
    report.death =
        std::string("ended by ") + ::strsignal(WTERMSIG(status)) + " at piece " + std::to_string(done);
  } else if (WEXITSTATUS(status) != 0) {
    report.death = "ended with " + std::to_string(WEXITSTATUS(status)) + " at piece " + std::to_string(done) +
                   ": " + (done < count ? shared[done].message : "");
  }
  ::munmap(shared, bytes);
  return report;
}

}  // namespace trocar::json_doors
