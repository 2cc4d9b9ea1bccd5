// SPDX-License-Identifier: Apache-2.0
/// \file part_folder.h  A folder of pictures, a video and pages that appears under its name only when all went well.
#pragma once

#include <filesystem>

#include "trocar/base/result.h"
#include "trocar/host/partial_path.h"

namespace trocar::cli {

class PartFolder {
 public:
  explicit PartFolder(const std::filesystem::path& target) : target_(target), part_(target) {}

  /// Where to write.
  const std::filesystem::path& Path() const { return part_.Path(); }
  /// Puts every file in place, and takes away the pictures and the video of an earlier run.
  /// \return kFileUnwritable
  base::Status Keep();

 private:
  std::filesystem::path target_;
  host::PartialPath part_;
};

}  // namespace trocar::cli
