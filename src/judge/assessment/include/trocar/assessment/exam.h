// SPDX-License-Identifier: Apache-2.0
/// \file exam.h  Settings of an exam that nobody can change or know beforehand: the seed is drawn by chance and kept secret, a
/// commitment to all settings is published before the exam, and what was sealed is shown afterwards.
///
/// Files: schemas/exam.schema.json; docs/exams.md tells how an exam is held.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/assessment/proficiency.h"
#include "trocar/base/result.h"
#include "trocar/record/recording.h"
#include "trocar/scene/scene.h"

namespace trocar::assessment {

struct ExamSettings {
  std::string name;               ///< for people
  std::string task, level;        ///< a task with its level, or ...
  std::string operation;          ///< ... an operation, on a patient that is generated from the seed
  std::vector<Threshold> passes;  ///< what passes, besides completing; may be empty
  std::string sealed;             ///< wall clock, UTC: "2026-11-25T03:10:00Z"
  std::uint64_t seed = 0;         ///< secret; of the task's random parameters, or of the patient
  std::string nonce;              ///< secret: 64 hexadecimal digits, so that nobody finds the seed by trying
  std::string commitment;         ///< 64 hexadecimal digits, see CalcCommitment

  bool IsOperation() const { return !operation.empty(); }
};

/// Draws seed and nonce from the system's generator, and commits to them.
/// \param settings  name, task or operation, passes
/// \return kExamInvalid where it names what there is not
base::Result<ExamSettings> SealExam(ExamSettings settings);

/// BLAKE2b-256 of the canonical JSON of everything but the commitment.
std::string CalcCommitment(const ExamSettings& settings);

/// All of it: for the examiner alone until the exam is over.
std::string FormatExam(const ExamSettings& settings);
/// Without seed and nonce: to be published before.
std::string FormatPublishedExam(const ExamSettings& settings);

/// Writes FILE, which only its owner may read, and beside it FILE with ".published.json" in place of its ending.
/// \return the published file; kFileUnwritable, also where one is there already: a seal is not replaced
base::Result<std::filesystem::path> WriteExam(const std::filesystem::path& path,
                                              const ExamSettings& settings);

/// \return the file's error; kExamSealBroken where its commitment is not that of its settings
base::Result<ExamSettings> ReadExam(const std::filesystem::path& path);
/// \return kExamSealBroken where the settings are not those that were published
base::Status CheckPublished(const std::filesystem::path& published, const ExamSettings& settings);

/// Description for a recording of this exam. A patient is generated into the cache folder.
/// \param cache  empty: host::FindCacheFolder
base::Result<record::Description> DescribeExam(const ExamSettings& settings,
                                               const std::filesystem::path& cache = {});

}  // namespace trocar::assessment
