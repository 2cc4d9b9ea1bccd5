// SPDX-License-Identifier: Apache-2.0
/// \file patient_document.h  A patient that is being edited: undo and redo, unsaved changes, autosave.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

/// Undo is exact: it puts back what was there, bit for bit. Organs' meshes are never changed.
class PatientDocument {
 public:
  /// Opens a patient folder; with `is_recovered`, what was autosaved of it.
  /// \return the error of ReadPatient
  static base::Result<PatientDocument> Open(const std::filesystem::path& folder, bool is_recovered = false);
  PatientDocument(patient::Patient patient, std::filesystem::path folder);

  const patient::Patient& GetPatient() const { return patient_; }
  const std::filesystem::path& Folder() const { return folder_; }
  /// Names the present state: another number after every change, the same again after undo.
  std::uint64_t Revision() const { return revision_; }

  /// Runs an operation of patient_edit.h. Nothing changes when it fails, and nothing is remembered when it
  /// changes nothing.
  /// \param name  in words, for "Undo ..."
  base::Status Edit(const std::string& name, const std::function<base::Status(patient::Patient&)>& operation);
  /// Edits up to EndGroup are one step of undo: a stroke of the brush, a drag.
  void BeginGroup(const std::string& name);
  void EndGroup();

  bool CanUndo() const { return !undo_.empty(); }
  bool CanRedo() const { return !redo_.empty(); }
  std::string UndoName() const { return undo_.empty() ? "" : undo_.back().name; }
  std::string RedoName() const { return redo_.empty() ? "" : redo_.back().name; }
  /// \pre no group is open (TROCAR_ASSERT)
  void Undo();
  void Redo();
  /// Steps that are kept; the oldest are forgotten.
  static constexpr std::size_t kMaxSteps = 200;

  /// Whether there are changes that Save has not written.
  bool IsDirty() const { return revision_ != saved_revision_; }
  /// Writes the patient, which it is from now on, and removes the autosaved copy.
  /// \return the error of WritePatient; the document stays dirty
  base::Status Save(const std::filesystem::path& folder);

  /// Beside the patient's folder, with ".autosave" at its end.
  static std::filesystem::path AutosaveFolder(const std::filesystem::path& folder);
  /// Whether a copy lies there that was written after the patient itself.
  static bool HasAutosave(const std::filesystem::path& folder);
  /// Writes the copy where something has changed since the last one.
  /// \return true when it wrote
  base::Result<bool> Autosave();
  void DiscardAutosave();

 private:
  /// Parts of a patient that an edit can change; a step keeps only the parts that its edit did change.
  struct Parts {
    std::optional<std::vector<std::vector<patient::Region>>> regions;  // (organs)
    std::optional<std::vector<patient::Attachment>> attachments;
    std::optional<std::vector<patient::Tube>> tubes;
    std::optional<std::vector<patient::Landmark>> landmarks;
  };
  struct Step {
    std::string name;
    Parts before, after;
    std::uint64_t revision_before = 0, revision_after = 0;
  };
  static Parts TakeParts(const patient::Patient& patient);
  static void KeepDifferences(Parts& before, Parts& after);
  void Apply(const Parts& parts);
  void Remember(const std::string& name, Parts before);

  patient::Patient patient_;
  std::filesystem::path folder_;
  std::deque<Step> undo_, redo_;
  std::optional<Parts> group_;  // as it was at BeginGroup
  std::string group_name_;
  std::uint64_t revision_ = 0, saved_revision_ = 0, autosaved_revision_ = 0, last_revision_ = 0,
                group_revision_ = 0;
};

}  // namespace trocar::anatomy
