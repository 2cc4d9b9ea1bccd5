// SPDX-License-Identifier: Apache-2.0
/// \file work_folder.h  A folder for one run of a benchmark.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include "trocar/base/result.h"

namespace trocar::bench {

/// Empty when it is made; gone, with what lies in it, when it ends.
class WorkFolder {
 public:
  WorkFolder() {
    std::string path = (std::filesystem::temp_directory_path() / "trocar-bench-XXXXXX").string();
    if (::mkdtemp(path.data()) != nullptr) path_ = path;
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  /// \return kFileUnwritable where it could not be made; then there is no path
  base::Status Status() const {
    if (!path_.empty()) return {};
    return base::Error{base::ErrorCode::kFileUnwritable,
                       "no folder can be made for the benchmark; check TMPDIR"};
  }
  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace trocar::bench
