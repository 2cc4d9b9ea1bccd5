// SPDX-License-Identifier: Apache-2.0
#include "trocar/study/study.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <set>
#include <thread>

#include "bound_child.h"
#include "study_folder.h"
#include "table.h"
#include "trocar/host/console.h"
#include "trocar/host/file_lock.h"
#include "trocar/host/safe_file.h"

namespace trocar::study {
namespace {

constexpr int kNotThere = 127;  // exit status of a child whose program does not start
constexpr auto kLookAgain = std::chrono::milliseconds(250);

std::string QuoteForShell(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// A program with its output in a file, else where ours goes.
pid_t Start(const std::vector<std::string>& words, const std::filesystem::path& log) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  // asked to end, mpirun ends its ranks
  const pid_t child = ForkBound(SIGTERM);
  if (child != 0) return child;
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0) {
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
  }
  execvp(argv[0], argv.data());
  _exit(kNotThere);
}

std::string LastLines(const std::filesystem::path& path) {
  const auto text = host::ReadFile(path);
  constexpr std::size_t kMost = 500;
  if (!text) return "";
  return text->size() > kMost ? text->substr(text->size() - kMost) : *text;
}

/// Children that are awaited together, while the share of runs that are done is told.
class Children {
 public:
  void Add(pid_t child) { children_.insert(child); }
  /// \return statuses as of waitpid
  template <typename Tell>
  std::vector<int> Await(const Tell& tell) {
    std::vector<int> statuses;
    while (!children_.empty()) {
      for (auto child = children_.begin(); child != children_.end();) {
        int status = 0;
        const pid_t ended = waitpid(*child, &status, WNOHANG);
        if (ended == 0 || (ended < 0 && errno == EINTR)) {
          ++child;
          continue;
        }
        statuses.push_back(status);
        child = children_.erase(child);
      }
      tell();
      if (!children_.empty()) std::this_thread::sleep_for(kLookAgain);
    }
    return statuses;
  }

 private:
  std::set<pid_t> children_;
};

std::vector<std::string> WorkerCommand(const StudyOptions& options) {
  return {options.program.string(),
          "study",
          std::filesystem::absolute(options.plan_file).string(),
          "-o",
          std::filesystem::absolute(options.folder).string(),
          "--attempts",
          std::to_string(options.attempts),
          "--worker",
          "auto"};
}

base::Error Away(const std::string& what, const std::string& words) {
  return {base::ErrorCode::kClusterAway, what + (words.empty() ? "" : ": " + words) +
                                             "; check sinfo or mpirun by hand, or use --backend local"};
}

/// The job that a Slurm array runs: found again beside its results.
base::Result<std::vector<std::string>> SlurmCommand(const StudyOptions& options, const StudyPlan& plan) {
  std::string script = "#!/bin/sh\n# " + plan.name + "\nexec";
  for (const std::string& word : WorkerCommand(options)) script += " " + QuoteForShell(word);
  const std::filesystem::path file = options.folder / "slurm.sh";
  if (auto written = host::WriteFile(file, script + "\n"); !written) return written.error();
  std::vector<std::string> words = {
      "sbatch",
      "--wait",
      "--parsable",
      "--array=0-" + std::to_string(options.workers - 1),
      "--job-name=trocar-study",
      "--output=" + std::filesystem::absolute(options.folder / "logs").string() + "/slurm-%A_%a.log"};
  words.insert(words.end(), options.launch.begin(), options.launch.end());
  words.push_back(std::filesystem::absolute(file).string());
  return words;
}

std::vector<std::string> MpiCommand(const StudyOptions& options) {
  std::vector<std::string> words = {"mpirun", "-n", std::to_string(options.workers)};
  words.insert(words.end(), options.launch.begin(), options.launch.end());
  const std::vector<std::string> worker = WorkerCommand(options);
  words.insert(words.end(), worker.begin(), worker.end());
  return words;
}

/// Workers are forks: each runs its share and writes what it says into a log.
base::Status RunLocally(const StudyOptions& options, const StudyPlan& plan, host::FileLock& lock,
                        const std::function<void()>& tell) {
  Children children;
  for (int i = 0; i < options.workers; ++i) {
    const pid_t child = ForkBound(SIGKILL);
    if (child < 0)
      return base::Error{base::ErrorCode::kOutOfMemory, std::string("no process: ") + std::strerror(errno) +
                                                            "; ask for fewer workers (--jobs)"};
    if (child == 0) {
      lock.LeaveToParent();
      const base::Status worked = Work(options, plan, {i, options.workers});
      if (!worked.ok())
        host::PrintErrorLine("trocar: worker " + std::to_string(i) + ": " + worked.error().Text());
      std::fflush(nullptr);
      _exit(worked.ok() ? 0 : 1);
    }
    children.Add(child);
  }
  children.Await(tell);
  return {};
}

base::Status RunOnCluster(const StudyOptions& options, const StudyPlan& plan,
                          const std::function<void()>& tell) {
  const bool is_slurm = options.backend == Backend::kSlurm;
  std::vector<std::string> words;
  if (is_slurm) {
    auto made = SlurmCommand(options, plan);
    if (!made) return made.error();
    words = std::move(*made);
  } else {
    words = MpiCommand(options);
  }
  const std::filesystem::path log = options.folder / "logs" / (is_slurm ? "sbatch.log" : "mpirun.log");
  Children children;
  const pid_t child = Start(words, log);
  if (child < 0) return Away("no process for " + words[0], std::strerror(errno));
  children.Add(child);
  const std::vector<int> statuses = children.Await(tell);
  const int status = statuses.front();
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotThere)
    return Away(words[0] + " is not installed here", "");
  // an array or a rank that failed: what is missing is counted afterwards; one that was never taken has no job
  const std::string said = LastLines(log);
  const bool is_refused = is_slurm && said.find("error:") != std::string::npos &&
                          said.find("submission failed") != std::string::npos;
  const bool is_away = is_slurm && said.find("Unable to contact") != std::string::npos;
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0 && (is_refused || is_away || !is_slurm))
    return Away(words[0] + " ended with status " + std::to_string(WEXITSTATUS(status)), said);
  return {};
}

}  // namespace

base::Result<StudySummary> RunStudy(const StudyOptions& options, const StudyPlan& plan,
                                    const std::function<void(double share)>& on_progress) {
  namespace fs = std::filesystem;
  const StudyFolder folder(options.folder);
  std::error_code failure;
  fs::create_directories(options.folder / "logs", failure);
  if (failure)
    return base::Error{base::ErrorCode::kFileUnwritable, options.folder.string() + ": " + failure.message() +
                                                             "; check the folder and its rights"};
  // two of them would start every run twice
  auto lock = host::FileLock::Take(options.folder / "lock");
  if (!lock) return lock.error();
  if (auto status = folder.Begin(options.plan_file); !status) return status.error();
  const std::vector<Run> runs = ListRuns(plan);
  std::vector<const Run*> open;
  for (const Run& run : runs) open.push_back(&run);
  const auto tell = [&] {
    std::erase_if(open, [&](const Run* run) { return folder.FindResult(*run).has_value(); });
    if (on_progress) on_progress(1.0 - static_cast<double>(open.size()) / static_cast<double>(runs.size()));
  };
  tell();
  if (!open.empty()) {
    const base::Status ran = options.backend == Backend::kLocal ? RunLocally(options, plan, *lock, tell)
                                                                : RunOnCluster(options, plan, tell);
    if (!ran) return ran.error();
  }
  StudySummary summary;
  summary.runs = runs.size();
  std::vector<Row> rows;
  std::set<std::string> seen;
  for (const Run& run : runs) {
    auto result = folder.FindResult(run);
    if (result) {
      ++summary.done;
      // two cells with equal inputs are one run, and count once
      if (seen.insert(run.key).second) rows.push_back({run, std::move(*result)});
    } else if (const auto why = folder.FindFailure(run)) {
      ++summary.failed;
      summary.failures.push_back(run.key + " " + Describe(plan, run) + ": " + *why);
    }
  }
  if (auto status = WriteCsv(options.folder / "runs.csv", plan, rows); !status) return status.error();
  if (auto status = WriteSqlite(options.folder / "runs.sqlite", plan, rows); !status) return status.error();
  if (auto status = WriteHdf5(options.folder / "runs.h5", plan, rows); !status) return status.error();
  if (auto status = WriteReport(options.folder / "report.html", plan, rows, summary); !status)
    return status.error();
  return summary;
}

}  // namespace trocar::study
