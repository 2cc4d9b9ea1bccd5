// SPDX-License-Identifier: Apache-2.0
#include "command_runs.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "trocar/cli/run_command.h"
#include "trocar/host/printable_output.h"
#include "trocar/host/safe_file.h"

namespace trocar::printed_texts {
namespace {

constexpr std::size_t kMostPrinted = std::size_t{64} << 20;

std::string FindFaultIn(const std::string& text, const char* what) {
  if (host::PrintableText(text) != text) {
    std::size_t at = 0;
    while (at < text.size() && host::PrintableText(text.substr(0, at + 1)) == text.substr(0, at + 1)) ++at;
    const std::size_t begin = at > 60 ? at - 60 : 0;
    return std::string(what) + " holds what steers a terminal, behind: " +
           host::PrintableLine(text.substr(begin, at + 4 - begin));
  }
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = text.find('\n', at);
    if (end == std::string::npos) end = text.size();
    std::string_view line(text.data() + at, end - at);
    while (!line.empty() && (line[0] == ' ' || line[0] == '\t')) line.remove_prefix(1);
    if (line.starts_with(kForgedLine)) {
      const std::size_t begin = at > 80 ? at - 80 : 0;
      return std::string(what) +
             " has a forged line, behind: " + host::PrintableLine(text.substr(begin, at - begin));
    }
    at = end + 1;
  }
  return {};
}

}  // namespace

std::string MakeHostileText() {
  const std::string forged(kForgedLine);
  return "x\n" + forged + " 1\r\n" + forged + " 2\x1b[2J\x1b[1;1H\x1b]0;title\x07\x1b]52;c;eA==\x07" +
         "\x7f\xc2\x9b" + "31m\xe2\x80\xae\xe2\x80\xa8\xe2\x81\xa6\xf3\xa0\x81\x81\t\v\f\b<b>&\"'\n" +
         forged + " 3";
}

std::string MakeLongText() {
  const std::string filling(20'000, 'W');
  return "x" + filling + MakeHostileText() + filling;
}

std::string MakeBrokenText() {
  return "x\xff\xc0\x80\xed\xa0\x80" + MakeHostileText() + "\xc3";
}

CommandRun RunInChild(const std::vector<std::string>& given, const std::filesystem::path& folder,
                      unsigned most_seconds) {
  const std::filesystem::path out = folder / ".out", err = folder / ".err";
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    ::alarm(most_seconds);
    ::setpgid(0, 0);
    for (const auto& [path, file] : {std::pair{out, STDOUT_FILENO}, std::pair{err, STDERR_FILENO}})
      ::dup2(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), file);
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    for (const char* name : {"HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"})
      ::setenv(name, folder.c_str(), 1);
    // no window opens
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "TROCAR_STORE"}) ::unsetenv(name);
    if (::chdir(folder.c_str()) != 0) ::_exit(99);
    std::vector<std::string> words = given;
    words.insert(words.begin(), "trocar");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    const int status = cli::RunCommand(static_cast<int>(argv.size()), argv.data());
    std::fflush(nullptr);
    ::_exit(status);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ::kill(-child, SIGKILL);  // what it started
  CommandRun run;
  run.is_late = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  run.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  const auto read = [](const std::filesystem::path& path) {
    auto text = host::ReadFile(path, kMostPrinted);
    return text.ok() ? std::move(*text) : std::string();
  };
  run.out = read(out), run.err = read(err);
  return run;
}

std::string FindFault(const CommandRun& run, bool is_json) {
  if (run.is_late) return "it has not ended";
  if (run.status >= 128) return "a signal ended it: " + std::to_string(run.status - 128);
  if (run.err.find("unexpected exception") != std::string::npos)
    return "an exception: " + host::PrintableLine(run.err.substr(0, 500));
  for (const auto& [text, what] : {std::pair{&run.out, "stdout"}, std::pair{&run.err, "stderr"}}) {
    if (auto fault = FindFaultIn(*text, what); !fault.empty()) return fault;
  }
  if (is_json && !run.out.empty() && !nlohmann::json::accept(run.out))
    return "its output is no JSON: " + host::PrintableLine(run.out.substr(0, 200));
  return {};
}

}  // namespace trocar::printed_texts
