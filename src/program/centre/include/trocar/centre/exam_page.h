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
  std::string finding;  ///< of the certificate, in words
};

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
