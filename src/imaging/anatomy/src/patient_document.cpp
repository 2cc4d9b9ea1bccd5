// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_document.h"

#include <utility>

#include "trocar/base/assert.h"
#include "trocar/files/patient_file.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;

}  // namespace

PatientDocument::PatientDocument(patient::Patient patient, fs::path folder)
    : patient_(std::move(patient)), folder_(std::move(folder)) {}

base::Result<PatientDocument> PatientDocument::Open(const fs::path& folder, bool is_recovered) {
  auto patient = files::ReadPatient(is_recovered ? AutosaveFolder(folder) : folder);
  if (!patient) return patient.error();
  PatientDocument document(std::move(*patient), folder);
  // what was recovered is not yet saved
  if (is_recovered) document.revision_ = document.last_revision_ = document.autosaved_revision_ = 1;
  return document;
}

PatientDocument::Parts PatientDocument::TakeParts(const patient::Patient& patient) {
  Parts parts;
  parts.regions.emplace();
  for (const patient::Organ& organ : patient.organs) parts.regions->push_back(organ.regions);
  parts.attachments = patient.attachments;
  parts.tubes = patient.tubes;
  parts.landmarks = patient.landmarks;
  return parts;
}

void PatientDocument::KeepDifferences(Parts& before, Parts& after) {
  const auto drop_equal = [](auto& a, auto& b) {
    if (a == b) a.reset(), b.reset();
  };
  drop_equal(before.regions, after.regions);
  drop_equal(before.attachments, after.attachments);
  drop_equal(before.tubes, after.tubes);
  drop_equal(before.landmarks, after.landmarks);
}

void PatientDocument::Apply(const Parts& parts) {
  if (parts.regions) {
    for (std::size_t i = 0; i < patient_.organs.size(); ++i) patient_.organs[i].regions = (*parts.regions)[i];
  }
  if (parts.attachments) patient_.attachments = *parts.attachments;
  if (parts.tubes) patient_.tubes = *parts.tubes;
  if (parts.landmarks) patient_.landmarks = *parts.landmarks;
}

void PatientDocument::Remember(const std::string& name, Parts before) {
  Step step{name, std::move(before), TakeParts(patient_), revision_, 0};
  KeepDifferences(step.before, step.after);
  const bool has_changed =
      step.after.regions || step.after.attachments || step.after.tubes || step.after.landmarks;
  if (!has_changed) return;
  revision_ = step.revision_after = ++last_revision_;
  undo_.push_back(std::move(step));
  if (undo_.size() > kMaxSteps) undo_.pop_front();
  redo_.clear();
}

base::Status PatientDocument::Edit(const std::string& name,
                                   const std::function<base::Status(patient::Patient&)>& operation) {
  Parts before = TakeParts(patient_);
  if (auto status = operation(patient_); !status) {
    Apply(before);
    return status;
  }
  if (group_) {
    // one step at the end; those who draw want to know now
    revision_ = ++last_revision_;
  } else {
    Remember(name, std::move(before));
  }
  return {};
}

void PatientDocument::BeginGroup(const std::string& name) {
  if (group_) EndGroup();
  group_ = TakeParts(patient_);
  group_name_ = name;
  group_revision_ = revision_;
}

void PatientDocument::EndGroup() {
  if (!group_) return;
  Parts before = std::move(*group_);
  group_.reset();
  // as if nothing had happened since the beginning, unless something has
  revision_ = group_revision_;
  Remember(group_name_, std::move(before));
}

void PatientDocument::Undo() {
  TROCAR_ASSERT(!group_);
  if (undo_.empty()) return;
  Step step = std::move(undo_.back());
  undo_.pop_back();
  Apply(step.before);
  revision_ = step.revision_before;
  redo_.push_back(std::move(step));
}

void PatientDocument::Redo() {
  TROCAR_ASSERT(!group_);
  if (redo_.empty()) return;
  Step step = std::move(redo_.back());
  redo_.pop_back();
  Apply(step.after);
  revision_ = step.revision_after;
  undo_.push_back(std::move(step));
}

base::Status PatientDocument::Save(const fs::path& folder) {
  if (group_) EndGroup();
  if (auto status = files::WritePatient(folder, patient_); !status) return status;
  DiscardAutosave();
  folder_ = folder;
  saved_revision_ = autosaved_revision_ = revision_;
  return {};
}

fs::path PatientDocument::AutosaveFolder(const fs::path& folder) {
  fs::path target = folder;
  if (!target.has_filename()) target = target.parent_path();
  return target.string() + ".autosave";
}

bool PatientDocument::HasAutosave(const fs::path& folder) {
  std::error_code failure;
  const auto copied = fs::last_write_time(AutosaveFolder(folder) / "patient.json", failure);
  if (failure) return false;
  const auto written = fs::last_write_time(folder / "patient.json", failure);
  return failure || copied > written;
}

base::Result<bool> PatientDocument::Autosave() {
  if (!IsDirty() || autosaved_revision_ == revision_) return false;
  if (auto status = files::WritePatient(AutosaveFolder(folder_), patient_); !status) return status.error();
  autosaved_revision_ = revision_;
  return true;
}

void PatientDocument::DiscardAutosave() {
  std::error_code ignored;
  const fs::path copy = AutosaveFolder(folder_);
  // only what we wrote
  if (fs::exists(copy / "patient.json", ignored)) fs::remove_all(copy, ignored);
}

}  // namespace trocar::anatomy
