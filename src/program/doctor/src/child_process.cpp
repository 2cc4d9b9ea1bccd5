// SPDX-License-Identifier: Apache-2.0
#include "child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include "trocar/host/clock.h"

namespace trocar::doctor {
namespace {

constexpr std::size_t kLongestAnswer = 4096;  // fits into a pipe, so the child never waits for a reader

/// In the child: answers and ends without running anybody's exit handlers.
[[noreturn]] void Answer(const std::function<bool(std::string& text)>& question, int pipe_end) {
  // no core file, and a driver's chatter does not reach the terminal
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
  }
  std::string text;
  bool is_good = false;
  try {
    is_good = question(text);
  } catch (const std::exception& failure) {
    text = failure.what();
  }
  text.resize(std::min(text.size(), kLongestAnswer));
  const bool is_written = ::write(pipe_end, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::_exit(is_good && is_written ? 0 : 1);
}

/// Reads until the child closes its end.
/// \return false when the time ran out
bool ReadAll(int pipe_end, double timeout, std::string& text) {
  const host::Stopwatch stopwatch;
  char part[kLongestAnswer];
  for (;;) {
    const double left = timeout - stopwatch.Seconds();
    if (left <= 0) return false;
    pollfd wait{pipe_end, POLLIN, 0};
    const int ready = ::poll(&wait, 1, static_cast<int>(1e3 * left) + 1);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return false;
    const ssize_t got = ::read(pipe_end, part, sizeof part);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return true;
    text.append(part, static_cast<std::size_t>(got));
  }
}

}  // namespace

ChildAnswer AskChild(const std::function<bool(std::string& text)>& question, double timeout) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return {ChildEnd::kFailed, std::strerror(errno)};
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child < 0) {
    const std::string why = std::strerror(errno);
    ::close(ends[0]);
    ::close(ends[1]);
    return {ChildEnd::kFailed, why};
  }
  if (child == 0) {
    ::close(ends[0]);
    Answer(question, ends[1]);
  }
  ::close(ends[1]);
  ChildAnswer answer;
  const bool is_over = ReadAll(ends[0], timeout, answer.text);
  ::close(ends[0]);
  if (!is_over) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!is_over)
    return {ChildEnd::kTimedOut, "no answer in " + std::to_string(static_cast<int>(timeout)) + " s"};
  if (WIFSIGNALED(status)) {
    return {ChildEnd::kCrashed, std::string("it crashed: ") + ::strsignal(WTERMSIG(status))};
  }
  answer.end = WEXITSTATUS(status) == 0 ? ChildEnd::kAnswered : ChildEnd::kFailed;
  return answer;
}

}  // namespace trocar::doctor
