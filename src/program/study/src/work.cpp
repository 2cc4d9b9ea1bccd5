// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "bound_child.h"
#include "study_folder.h"

namespace trocar::study {
namespace {

constexpr int kFailed = 3;                 // exit status of a run that ended with an error
constexpr std::size_t kLongestWhy = 2000;  // bytes

std::optional<int> ReadNumber(std::string_view text) {
  int number = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return number;
}
std::optional<int> ReadVariable(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? std::nullopt : ReadNumber(text);
}

/// In a process of its own: what kills a run does not kill the worker.
/// \return why it failed, or nothing
std::optional<std::string> TryRun(const StudyFolder& folder, const StudyPlan& plan, const Run& run) {
  int ends[2] = {-1, -1};
  if (pipe(ends) != 0) return std::string("no pipe: ") + std::strerror(errno);
  const pid_t child = ForkBound(SIGKILL);
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return std::string("no process: ") + std::strerror(errno);
  }
  if (child == 0) {
    close(ends[0]);
    const auto result = PlayRun(plan, run);
    const base::Status kept = result.ok() ? folder.Keep(plan, run, *result) : base::Status(result.error());
    if (kept.ok()) _exit(0);
    const std::string why = kept.error().Text().substr(0, kLongestWhy);
    const bool is_told = write(ends[1], why.data(), why.size()) >= 0;
    _exit(is_told ? kFailed : kFailed + 1);
  }
  close(ends[1]);
  std::string why;
  char block[512];
  for (ssize_t got = 0; (got = read(ends[0], block, sizeof block)) != 0;) {
    if (got > 0) why.append(block, static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) break;
  }
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return std::nullopt;
  if (WIFSIGNALED(status)) return std::string("ended by signal ") + strsignal(WTERMSIG(status));
  return why.empty() ? "ended with status " + std::to_string(WEXITSTATUS(status)) : why;
}

}  // namespace

std::optional<Backend> FindBackend(std::string_view name) noexcept {
  if (name == "local") return Backend::kLocal;
  if (name == "slurm") return Backend::kSlurm;
  if (name == "mpi") return Backend::kMpi;
  return std::nullopt;
}

base::Result<Worker> FindWorker(const std::string& text) {
  std::optional<int> index, count;
  if (text == "auto") {
    index = ReadVariable("SLURM_ARRAY_TASK_ID"), count = ReadVariable("SLURM_ARRAY_TASK_COUNT");
    if (const auto first = ReadVariable("SLURM_ARRAY_TASK_MIN"); index && first) index = *index - *first;
    if (!index) index = ReadVariable("OMPI_COMM_WORLD_RANK"), count = ReadVariable("OMPI_COMM_WORLD_SIZE");
    if (!index) index = ReadVariable("PMI_RANK"), count = ReadVariable("PMI_SIZE");
  } else if (const std::size_t slash = text.find('/'); slash != std::string::npos) {
    index = ReadNumber(std::string_view(text).substr(0, slash));
    count = ReadNumber(std::string_view(text).substr(slash + 1));
  }
  if (index && count && *index >= 0 && *index < *count) return Worker{*index, *count};
  return base::Error{
      base::ErrorCode::kUsage,
      "--worker is INDEX/COUNT with INDEX from 0, or auto inside of a Slurm array or under mpirun; this "
      "is \"" +
          text + "\""};
}

base::Status Work(const StudyOptions& options, const StudyPlan& plan, const Worker& worker) {
  const StudyFolder folder(options.folder);
  if (auto status = folder.Begin(options.plan_file); !status) return status;
  for (const Run& run : ListRuns(plan)) {
    if (run.index % static_cast<std::size_t>(worker.count) != static_cast<std::size_t>(worker.index))
      continue;
    if (folder.FindResult(run)) continue;
    std::optional<std::string> why;
    for (int attempt = 0; attempt < options.attempts; ++attempt) {
      why = TryRun(folder, plan, run);
      if (!why) break;
    }
    if (!why) {
      folder.ForgetFailure(run);
      continue;
    }
    const std::string after = *why + " (" + std::to_string(options.attempts) + " attempts)";
    if (auto status = folder.NoteFailure(plan, run, after); !status) return status;
  }
  return {};
}

}  // namespace trocar::study
