// SPDX-License-Identifier: Apache-2.0
/// \file contour_side_file.h  The side file that keeps unsaved contours, and the lock that gives it to one window.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "trocar/contours/contour_autosave.h"
#include "trocar/contours/contour_workspace.h"
#include "trocar/host/file_lock.h"

namespace trocar::editor {

/// Where the unsaved contours of a workspace are kept: beside their file, nameless ones by the place of their pictures.
/// \param user_folder  of this person's data
std::filesystem::path FindSideFile(const contours::WorkspaceOptions& options,
                                   const std::filesystem::path& user_folder);

class ContourSideFile {
 public:
  /// Gives up what it had, and takes the file for this window.
  /// \return kFileInUse where another window has it
  base::Status Take(const std::filesystem::path& file);
  /// Gives the file up.
  void Release();
  bool IsTaken() const { return lock_.has_value(); }

  /// Contours that an earlier window left in it. \pre IsTaken() (TROCAR_ASSERT)
  base::Result<std::optional<contours::ControlPoints>> FindLeft(const std::string& saved_text) const;

  /// Keeps what is offered from now on. \pre IsTaken() (TROCAR_ASSERT)
  void Start();
  bool IsKeeping() const { return autosave_ != nullptr; }
  /// Newest wins; nothing where it does not keep.
  void Offer(const std::string& text);
  /// Everything is saved.
  void Discard();
  std::size_t WrittenCount() const { return autosave_ != nullptr ? autosave_->WrittenCount() : 0; }
  base::Status LastStatus() const { return autosave_ != nullptr ? autosave_->LastStatus() : base::Status(); }

 private:
  std::filesystem::path file_;
  std::optional<host::FileLock> lock_;
  std::unique_ptr<contours::ContourAutosave> autosave_;
};

}  // namespace trocar::editor
