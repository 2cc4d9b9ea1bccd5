// SPDX-License-Identifier: Apache-2.0
#include "picture_folder.h"

#include <glibmm.h>

#include <system_error>

#include "trocar/presenter/film_job.h"

namespace trocar::app {

base::Result<std::filesystem::path> MakePictureName(const std::string& ending) {
  const std::filesystem::path folder =
      presenter::PictureFolder(Glib::get_user_special_dir(Glib::UserDirectory::PICTURES));
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    return base::Error{base::ErrorCode::kFileUnwritable,
                       folder.string() + ": " + failure.message() + "; check the folder and its permissions"};
  return presenter::NamePicture(folder, std::chrono::system_clock::now(), ending);
}

}  // namespace trocar::app
