// SPDX-License-Identifier: Apache-2.0
/// \file study.h  Runs of a plan on this machine, as a Slurm job array or as MPI ranks; what is done is kept by the key of its
/// inputs, so that a study that was stopped goes on.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/study/plan.h"

namespace trocar::study {

enum class Backend { kLocal, kSlurm, kMpi };
/// "local", "slurm", "mpi"
std::optional<Backend> FindBackend(std::string_view name) noexcept;

struct StudyOptions {
  std::filesystem::path plan_file, folder;
  Backend backend = Backend::kLocal;
  int workers = 1;
  int attempts = 3;                 ///< that a run gets before it is named as failed, per start of the study
  std::filesystem::path program;    ///< that the cluster starts
  std::vector<std::string> launch;  ///< further options for sbatch or mpirun
};

/// Which share of the runs a worker does: those whose place is `index` modulo `count`.
struct Worker {
  int index = 0, count = 1;
};
/// "2/8", or "auto": what Slurm (SLURM_ARRAY_TASK_ID) or MPI (OMPI_COMM_WORLD_RANK, PMI_RANK) say in the environment.
/// \return kUsage
base::Result<Worker> FindWorker(const std::string& text);

/// Result of one run.
struct RunResult {
  std::vector<std::pair<std::string, double>> numbers;  ///< as in columns of the table
  std::string outcome;                                  ///< "completed", "time over", "given up", ...
  std::string state_hash;
};
/// \return errors of scene, surgeon and simulation
base::Result<RunResult> PlayRun(const StudyPlan& plan, const Run& run);

/// Does a worker's share, each run in a process of its own. \return kStudyChanged, kFileUnwritable
base::Status Work(const StudyOptions& options, const StudyPlan& plan, const Worker& worker);

struct StudySummary {
  std::size_t runs = 0, done = 0, failed = 0;
  std::vector<std::string> failures;  ///< a line each: key, inputs, why
};
/// Starts workers, waits for them, and writes runs.csv, runs.sqlite and report.html of what is done.
/// \return kStudyInvalid, kStudyChanged, kClusterAway, kFileUnwritable
base::Result<StudySummary> RunStudy(const StudyOptions& options, const StudyPlan& plan,
                                    const std::function<void(double share)>& on_progress);

}  // namespace trocar::study
