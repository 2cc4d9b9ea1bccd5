// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/secret_prompt.h"

#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>

#include "trocar/host/printable_output.h"

namespace trocar::host {
namespace {

/// While it lives, the terminal shows no key. Signals wait, so that none leaves the terminal like that.
class SilentTerminal {
 public:
  explicit SilentTerminal(int file) : file_(file) {
    ::sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &signals_);
    is_silent_ = ::tcgetattr(file_, &settings_) == 0;
    if (!is_silent_) return;
    ::termios silent = settings_;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    is_silent_ = ::tcsetattr(file_, TCSAFLUSH, &silent) == 0;
  }
  ~SilentTerminal() {
    if (is_silent_) ::tcsetattr(file_, TCSAFLUSH, &settings_);
    ::pthread_sigmask(SIG_SETMASK, &signals_, nullptr);
  }
  SilentTerminal(const SilentTerminal&) = delete;
  SilentTerminal& operator=(const SilentTerminal&) = delete;
  bool IsSilent() const { return is_silent_; }

 private:
  int file_;
  bool is_silent_ = false;
  ::termios settings_{};
  ::sigset_t signals_{};
};

}  // namespace

std::optional<std::string> AskInSecret(const std::string& question) {
  if (::isatty(STDIN_FILENO) != 1) return std::nullopt;
  const SilentTerminal silent(STDIN_FILENO);
  if (!silent.IsSilent()) return std::nullopt;
  std::fprintf(stderr, "%s: ", PrintableLine(question).c_str());
  std::string answer;
  for (int c = std::getchar(); c != EOF && c != '\n'; c = std::getchar()) answer += static_cast<char>(c);
  std::fputc('\n', stderr);
  return answer;
}

}  // namespace trocar::host
