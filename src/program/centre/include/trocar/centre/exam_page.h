// SPDX-License-Identifier: Apache-2.0
/// \file exam_page.h  An exam in the window: a sealed file is opened, sat without guidance, and certified.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trocar/assessment/exam.h"
#include "trocar/assessment/signing_key.h"
#include "trocar/centre/access.h"
#include "trocar/centre/course_page.h"

namespace trocar::centre {

/// What an examiner chooses: tasks and operations with their levels.
struct ExamChoice {
  std::string key, name;
  std::vector<std::string> levels;  ///< keys; empty of an operation
};

struct ExamPage {
  std::filesystem::path file;  ///< empty: none is open
  std::string name;
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::string> thresholds;  ///< in words
  std::string examinee;                 ///< pseudonym of who sits it, or has sat it
  std::string examinee_name;            ///< for a person; the pseudonym where no name is known
  std::filesystem::path recording;      ///< of the exam that was sat; empty before
  std::filesystem::path certificate;    ///< that was issued; empty before
  bool is_passed = false;
  std::string finding;              ///< of the certificate, in words
  std::vector<ExamChoice> choices;  ///< of an exam to seal
};

base::Result<std::vector<ExamChoice>> ListExamChoices();

/// Draws a secret seed and seals the settings; what passes are the delivered thresholds of task and level, where there are.
/// \param file  of the exam, for its examiner alone; beside it lies what is published before
/// \return the page of the sealed exam; the seal's error
base::Result<ExamPage> SealExamFile(const std::string& name, const std::string& task,
                                    const std::string& level, const std::filesystem::path& file);

/// Makes a centre's pair of keys: FILE.key stays secret, FILE.pub is published.
/// \return as assessment::MakeKeys
base::Status MakeCentreKeys(const std::filesystem::path& file, const std::string& passphrase);

/// \return the exam's error
base::Result<ExamPage> OpenExam(const std::filesystem::path& file);

/// The scene of the exam; an operation's patient is generated for it. \return kExamInvalid without an examinee
base::Result<Start> PrepareExam(const ExamPage& page);

/// Signs what the recording came to, writes it, checks it as anybody would, and keeps it in the store.
/// \param key       with an empty passphrase that of the environment is taken
/// \param progress  as in assessment::ReplaySettings
/// \return the page with its certificate; the certificate's error; kFileUnwritable where `file` is there already
base::Result<ExamPage> IssueExamCertificate(const Access& access, ExamPage page, assessment::SigningKey key,
                                            const std::filesystem::path& file,
                                            const std::function<bool(double)>& progress);

}  // namespace trocar::centre
