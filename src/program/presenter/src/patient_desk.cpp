// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/patient_desk.h"

#include <cctype>
#include <system_error>
#include <utility>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/translate.h"
#include "trocar/host/user_folder.h"
#include "trocar/patient/patient.h"

namespace trocar::presenter {
namespace {

namespace fs = std::filesystem;

base::Error Cancelled() {
  return {base::ErrorCode::kCancelled, "the patient was given up; nothing was written"};
}

/// "Case 3 (CT).nii.gz": "Case-3-CT"
std::string NameOfLabels(const fs::path& labels) {
  std::string name = labels.filename().string();
  name = name.substr(0, name.find('.'));
  std::string kept;
  for (const char c : name) {
    const bool is_good = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
    if (is_good) kept += c;
    if (!is_good && !kept.empty() && kept.back() != '-') kept += '-';
  }
  while (!kept.empty() && kept.back() == '-') kept.pop_back();
  return kept.empty() ? "imported" : kept;
}

/// Many programs call every map "segmentation": one that is called like a patient who is there is somebody else's.
std::string FreeName(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  std::string free = name;
  for (int n = 2; fs::exists(folder / free, ignored); ++n) free = name + "-" + std::to_string(n);
  return free;
}

}  // namespace

PatientDesk::PatientDesk(fs::path folder, std::function<void()> on_news)
    : folder_(std::move(folder)), job_(std::move(on_news)) {}

PatientDesk::~PatientDesk() {
  Cancel();
}

void PatientDesk::List() {
  if (job_.IsRunning()) {
    is_list_due_ = true;
    return;
  }
  work_ = std::make_shared<Work>();
  work_->progress.Set(host::Translate("Reading the patients"), -1);
  page_.can_cancel = false;
  job_.Start([folder = folder_, chosen = page_.chosen] {
    return Outcome{ListPatients(folder, chosen), std::nullopt, std::nullopt};
  });
}

void PatientDesk::Make(const std::string& name, const std::string& doing, Maker maker) {
  if (job_.IsRunning()) return;
  page_.problem.reset();
  work_ = std::make_shared<Work>();
  work_->progress.Set(doing, -1);
  page_.can_cancel = true;
  job_.Start([folder = folder_, chosen = page_.chosen, name, maker = std::move(maker), work = work_] {
    Outcome outcome;
    const fs::path target = folder / name;
    std::error_code failure;
    if (!fs::exists(target / "patient.json", failure)) {
      failure = host::MakeFolders(folder);
      // a patient is there as a whole, or not at all
      const host::PartialPath part(target);
      base::Status made = maker(part.Path(), *work);
      if (made.ok() && work->is_cancelled) made = Cancelled();
      if (made.ok()) {
        fs::rename(part.Path(), target, failure);
        if (failure)
          made = base::Error{base::ErrorCode::kFileUnwritable,
                             target.string() + " cannot be written: " + failure.message()};
      }
      if (!made.ok()) outcome.problem = made.error();
    }
    if (!outcome.problem) {
      outcome.made = target;
      work->progress.Set(host::Translate("Drawing its picture"), -1);
    }
    outcome.patients = ListPatients(folder, chosen);
    return outcome;
  });
}

void PatientDesk::Generate(std::uint64_t seed) {
  const std::string number = std::to_string(seed);
  Make("seed-" + number, host::TranslateWith("Making patient {1}", {number}),
       [seed](const fs::path& folder, Work& work) -> base::Status {
         const auto patient = anatomy::GeneratePatient(seed);
         if (!patient.ok()) return patient.error();
         if (work.is_cancelled) return Cancelled();
         return files::WritePatient(folder, *patient);
       });
}

void PatientDesk::Import(const fs::path& labels) {
  Make(FreeName(folder_, NameOfLabels(labels)),
       host::TranslateWith("Reading {1}", {labels.filename().string()}),
       [labels](const fs::path& folder, Work& work) -> base::Status {
         anatomy::LabelOptions options;
         options.labels = labels;
         options.output = folder;
         const auto built =
             anatomy::BuildPatientFromLabels(options, [&work](std::string_view what, double fraction) {
               work.progress.Set(host::TranslateComposed(what), fraction);
             });
         if (!built.ok()) return built.error();
         return {};
       });
}

void PatientDesk::Cancel() {
  if (work_ != nullptr && page_.can_cancel) work_->is_cancelled = true;
}

std::optional<fs::path> PatientDesk::Finish() {
  Outcome outcome = job_.Take();
  const bool is_cancelled = work_->is_cancelled;
  page_.patients = std::move(outcome.patients);
  // what was given up is no mistake
  if (!is_cancelled && page_.can_cancel) page_.problem = outcome.problem;
  page_.can_cancel = false;
  if (std::exchange(is_list_due_, false)) List();
  return is_cancelled ? std::nullopt : outcome.made;
}

const PatientPage& PatientDesk::Look() {
  page_.doing.clear();
  page_.fraction = 0;
  if (job_.IsRunning()) {
    const gui::JobProgress::Value now = work_->progress.Get();
    page_.doing = work_->is_cancelled ? host::Translate("Giving it up") : now.what;
    page_.fraction = now.fraction;
  }
  return page_;
}

}  // namespace trocar::presenter
