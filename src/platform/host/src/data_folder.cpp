// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/data_folder.h"

#include <cstdlib>
#include <string>
#include <vector>

#include "trocar/host/program.h"

namespace trocar::host {
namespace fs = std::filesystem;

namespace {

fs::path& DeliveredFolder() {
  static fs::path folder;
  return folder;
}

}  // namespace

void SetDataFolder(const fs::path& folder) {
  DeliveredFolder() = folder;
}

base::Result<fs::path> FindDataFolder() {
  std::vector<fs::path> places;
  if (const char* named = std::getenv("TROCAR_DATA_DIR"); named != nullptr && *named != '\0') {
    places.emplace_back(named);  // whoever names a folder wants that one
  } else if (!DeliveredFolder().empty()) {
    places.push_back(DeliveredFolder());
  } else {
    places.push_back(FindInstallationFolder() / "share/trocar");
    places.push_back(FindProgramFolder());
    places.emplace_back(TROCAR_COMPILED_DATA_FOLDER);
  }
  std::string tried;
  for (const fs::path& place : places) {
    std::error_code failure;
    if (fs::is_directory(place / "assets", failure) && fs::is_directory(place / "scenes", failure)) {
      return fs::weakly_canonical(place);
    }
    tried += (tried.empty() ? "" : ", ") + place.string();
  }
  return base::Error{base::ErrorCode::kFileMissing, "no folder with assets/ and scenes/ was found (tried " +
                                                        tried + "); set TROCAR_DATA_DIR to it"};
}

}  // namespace trocar::host
