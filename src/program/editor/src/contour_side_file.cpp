// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_side_file.h"

#include <utility>

#include "trocar/base/assert.h"
#include "trocar/host/sha256.h"

namespace trocar::editor {

std::filesystem::path FindSideFile(const contours::WorkspaceOptions& options,
                                   const std::filesystem::path& user_folder) {
  if (!options.points.empty()) return contours::AutosavePath(options.points);
  // a sum of the pictures' path finds the file again and does not repeat a person's name that is part of it
  const std::string path = std::filesystem::absolute(options.images).lexically_normal().string();
  const std::string name = host::CalcSha256(path).substr(0, 32);
  return contours::AutosavePath(user_folder / "trocar" / "contours" / (name + ".json"));
}

base::Status ContourSideFile::Take(const std::filesystem::path& file) {
  Release();
  auto taken = host::FileLock::Take(file.string() + ".lock");
  if (!taken.ok()) return taken.error();
  lock_.emplace(std::move(*taken));
  file_ = file;
  return {};
}

void ContourSideFile::Release() {
  autosave_.reset();
  lock_.reset();
}

base::Result<std::optional<contours::ControlPoints>> ContourSideFile::FindLeft(
    const std::string& saved_text) const {
  TROCAR_ASSERT(IsTaken());
  return contours::FindAutosaved(file_, saved_text);
}

void ContourSideFile::Start() {
  TROCAR_ASSERT(IsTaken());
  autosave_ = std::make_unique<contours::ContourAutosave>(file_);
}

void ContourSideFile::Offer(const std::string& text) {
  if (autosave_ != nullptr) autosave_->Offer(text);
}

void ContourSideFile::Discard() {
  if (autosave_ != nullptr) autosave_->Discard();
}

}  // namespace trocar::editor
