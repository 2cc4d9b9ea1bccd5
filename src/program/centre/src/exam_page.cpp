// SPDX-License-Identifier: Apache-2.0
#include "trocar/centre/exam_page.h"

#include <system_error>
#include <utility>

#include "trocar/assessment/certificate.h"
#include "trocar/assessment/proficiency.h"
#include "trocar/centre/judged_attempt.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/store/attempts.h"
#include "trocar/store/people.h"
#include "words.h"

namespace trocar::centre {
namespace {

constexpr const char* kOperation = "cholecystectomy";

}  // namespace

base::Result<std::vector<ExamChoice>> ListExamChoices() {
  const auto tasks = files::ListTasks();
  if (!tasks.ok()) return tasks.error();
  std::vector<ExamChoice> choices;
  for (const files::TaskEntry& task : *tasks)
    choices.push_back({task.key, host::Translate(task.name), task.levels});
  choices.push_back({kOperation, TaskNameOf(kOperation), {}});
  return choices;
}

base::Result<ExamPage> SealExamFile(const std::string& name, const std::string& task,
                                    const std::string& level, const std::filesystem::path& file) {
  assessment::ExamSettings settings;
  settings.name = name;
  (task == kOperation ? settings.operation : settings.task) = task;
  settings.level = level;
  const auto known = assessment::ListProficiencies();
  if (!known.ok()) return known.error();
  for (const assessment::Proficiency& one : *known) {
    if (one.task == task && one.level == level) settings.passes = one.thresholds;
  }
  const auto sealed = assessment::SealExam(std::move(settings));
  if (!sealed.ok()) return sealed.error();
  if (const auto written = assessment::WriteExam(file, *sealed); !written.ok()) return written.error();
  return OpenExam(file);
}

base::Status MakeCentreKeys(const std::filesystem::path& file, const std::string& passphrase) {
  std::filesystem::path name = file;
  if (name.extension() == ".key" || name.extension() == ".pub") name.replace_extension();
  return assessment::MakeKeys(name, passphrase);
}

base::Result<ExamPage> OpenExam(const std::filesystem::path& file) {
  const auto exam = assessment::ReadExam(file);
  if (!exam.ok()) return exam.error();
  ExamPage page;
  page.file = file;
  page.name = exam->name;
  // neither seed nor nonce: whoever sits the exam looks on
  page.facts = {{host::Translate("Of"), exam->IsOperation()
                                            ? host::TranslateWith("{1}, on a patient that nobody has seen",
                                                                  {TaskNameOf(exam->operation)})
                                            : TaskNameOf(exam->task) + ", " + host::Translate(exam->level)},
                {host::Translate("Sealed"), report::FormatDate(exam->sealed)},
                {host::Translate("Commitment"), exam->commitment}};
  for (const assessment::Threshold& threshold : exam->passes)
    page.thresholds.push_back(ThresholdText(threshold));
  return page;
}

base::Result<Start> PrepareExam(const ExamPage& page) {
  if (page.examinee.empty()) {
    return base::Error{base::ErrorCode::kExamInvalid,
                       "nobody has said who sits the exam; say at \"Who are you?\" who you are"};
  }
  if (const auto sound = store::CheckPseudonym(page.examinee); !sound.ok()) return sound.error();
  const auto exam = assessment::ReadExam(page.file);
  if (!exam.ok()) return exam.error();
  auto description = assessment::DescribeExam(*exam);
  if (!description.ok()) return description.error();
  Start start;
  start.description = std::move(*description);
  start.title = host::TranslateWith("Exam: {1}", {exam->name});
  start.exam = ExamSitting{page.file, page.examinee};
  return start;
}

base::Result<ExamPage> IssueExamCertificate(const Access& access, ExamPage page, assessment::SigningKey key,
                                            const std::filesystem::path& file,
                                            const std::function<bool(double)>& progress) {
  const auto exam = assessment::ReadExam(page.file);
  if (!exam.ok()) return exam.error();
  // before the work of computing the exam again
  std::error_code failure;
  if (std::filesystem::exists(file, failure)) {
    return base::Error{
        base::ErrorCode::kFileUnwritable,
        file.string() + " is there already; a certificate is not replaced: choose another name"};
  }
  if (key.passphrase.empty()) key.passphrase = assessment::PassphraseOfEnvironment();
  assessment::ReplaySettings settings;
  settings.progress = progress;
  const auto text = assessment::IssueCertificate(*exam, page.recording, page.examinee, key, {}, settings);
  if (!text.ok()) return text.error();
  const auto certificate = assessment::ReadCertificate(*text, file.string());
  if (!certificate.ok()) return certificate.error();
  if (const auto written = host::WriteFile(file, *text); !written.ok()) return written.error();
  page.certificate = file;
  page.is_passed = certificate->is_passed;
  page.finding = certificate->is_passed ? host::Translate("Passed. The certificate is signed.")
                 : certificate->is_completed
                     ? host::Translate("Completed, not passed. The certificate is signed and says so.")
                     : host::Translate("Not completed. The certificate is signed and says so.");
  // the file is what counts; the store keeps a copy where it is there
  auto desk = OpenDesk({access.place, access.settings, {}});
  if (!desk.ok()) {
    page.finding +=
        host::TranslateWith(" The store does not have it yet: {1}", {host::ShownText(desk.error())});
    return page;
  }
  const auto kept =
      store::AddCertificate(desk->store, desk->viewer, {certificate->recording_hash, page.examinee, *text});
  if (!kept.ok())
    page.finding += host::TranslateWith(" The store does not have it: {1}", {host::ShownText(kept.error())});
  return page;
}

}  // namespace trocar::centre
