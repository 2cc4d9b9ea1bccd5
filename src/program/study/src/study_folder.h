// SPDX-License-Identifier: Apache-2.0
/// \file study_folder.h  Files of a study: DIR/study.json, DIR/results/KEY.json, DIR/failures/KEY.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "trocar/study/study.h"

namespace trocar::study {

class StudyFolder {
 public:
  explicit StudyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Notes plan and program at the first start; later ones must be the same.
  /// \return kStudyChanged, kFileUnwritable
  base::Status Begin(const std::filesystem::path& plan_file) const;

  /// Nothing where it is not there, or not whole.
  std::optional<RunResult> FindResult(const Run& run) const;
  base::Status Keep(const StudyPlan& plan, const Run& run, const RunResult& result) const;
  /// A run that failed as often as it may.
  base::Status NoteFailure(const StudyPlan& plan, const Run& run, const std::string& why) const;
  void ForgetFailure(const Run& run) const;
  /// Why, or nothing.
  std::optional<std::string> FindFailure(const Run& run) const;

  const std::filesystem::path& Path() const { return folder_; }

 private:
  std::filesystem::path ResultPath(const Run& run) const;
  std::filesystem::path FailurePath(const Run& run) const;

  std::filesystem::path folder_;
};

/// "surgeon=expert patient= seed=3 stiffness_scale=2"
std::string Describe(const StudyPlan& plan, const Run& run);

}  // namespace trocar::study
