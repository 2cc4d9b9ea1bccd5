// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/png_file.h"

#include <png.h>

#include <cstring>
#include <string>

#include "trocar/host/safe_file.h"

namespace trocar::images {

base::Status WritePng(const std::filesystem::path& path, const ColorImage& image) {
  png_image header;
  std::memset(&header, 0, sizeof(header));
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t bytes = 0;
  std::string content;
  bool is_written =
      png_image_write_to_memory(&header, nullptr, &bytes, 0, image.samples.data(), 0, nullptr) != 0;
  if (is_written) {
    content.resize(bytes);
    is_written =
        png_image_write_to_memory(&header, content.data(), &bytes, 0, image.samples.data(), 0, nullptr) != 0;
  }
  if (!is_written) {
    return base::Error{base::ErrorCode::kFileUnwritable,
                       path.string() + ": " + header.message + "; the picture was not written"};
  }
  return host::WriteFile(path, content);
}

}  // namespace trocar::images
