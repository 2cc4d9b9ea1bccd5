// SPDX-License-Identifier: Apache-2.0
#include "part_folder.h"

#include <string>
#include <system_error>
#include <vector>

namespace trocar::cli {

base::Status PartFolder::Keep() {
  namespace fs = std::filesystem;
  std::error_code failure;
  const auto unwritable = [&] {
    return base::Error{
        base::ErrorCode::kFileUnwritable,
        target_.string() + ": " + failure.message() + "; check the folder, its rights and the space left"};
  };
  fs::create_directories(target_, failure);
  if (failure) return unwritable();
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(target_, failure)) {
    const std::string name = entry.path().filename().string();
    if ((name.starts_with("picture_") && name.ends_with(".png")) || name == "demo.webm")
      old.push_back(entry.path());
  }
  for (const fs::path& path : old) fs::remove(path, failure);
  for (const fs::directory_entry& entry : fs::directory_iterator(Path(), failure)) {
    fs::rename(entry.path(), target_ / entry.path().filename(), failure);
    if (failure) return unwritable();
  }
  return {};
}

}  // namespace trocar::cli
