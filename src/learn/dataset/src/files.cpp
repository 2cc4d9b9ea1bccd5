// SPDX-License-Identifier: Apache-2.0
#include "files.h"

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>

// after cstdio, which it needs and does not include
#include <jpeglib.h>

#include "trocar/host/safe_file.h"

namespace trocar::dataset {
namespace {

constexpr int kJpegQuality = 95;

base::Error Unencodable(const std::filesystem::path& path, const std::string& why) {
  return {base::ErrorCode::kFileUnwritable, path.string() + " cannot be encoded: " + why};
}

/// libjpeg ends the program at an error unless it is told otherwise.
struct JpegFailure {
  jpeg_error_mgr manager;
  std::jmp_buf back;
};
[[noreturn]] void OnJpegError(j_common_ptr info) {
  std::longjmp(reinterpret_cast<JpegFailure*>(info->err)->back, 1);
}

/// \param[out] bytes  of malloc, for the caller to free
bool CompressJpeg(const render::Image& image, unsigned char** bytes, unsigned long* size) {
  jpeg_compress_struct info{};
  JpegFailure failure{};
  info.err = jpeg_std_error(&failure.manager);
  failure.manager.error_exit = OnJpegError;
  if (setjmp(failure.back) != 0) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, bytes, size);
  info.image_width = static_cast<JDIMENSION>(image.width);
  info.image_height = static_cast<JDIMENSION>(image.height);
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, kJpegQuality, TRUE);
  info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row =
        const_cast<JSAMPROW>(image.pixels.data() + std::size_t{3} * info.next_scanline * info.image_width);
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

}  // namespace

base::Status WriteGreyPng(const std::filesystem::path& path, int width, int height,
                          std::span<const std::uint8_t> pixels) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_GRAY;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
    return Unencodable(path, png.message);
  bytes.resize(size);
  return host::WriteFile(path, bytes);
}

base::Status WriteEqualChannelsPng(const std::filesystem::path& path, int width, int height,
                                   std::span<const std::uint8_t> pixels) {
  render::Image image{width, height, {}};
  image.pixels.reserve(3 * pixels.size());
  for (const std::uint8_t pixel : pixels) image.pixels.insert(image.pixels.end(), 3, pixel);
  return render::WritePng(path, image);
}

base::Status LinkFile(const std::filesystem::path& file, const std::filesystem::path& name) {
  std::error_code failure;
  std::filesystem::create_directories(name.parent_path(), failure);
  if (!failure) std::filesystem::create_hard_link(file, name, failure);
  if (failure) std::filesystem::copy_file(file, name, failure);
  if (!failure) return {};
  return base::Error{
      base::ErrorCode::kFileUnwritable,
      name.string() + ": " + failure.message() + "; check the folder, its rights and the space left"};
}

base::Status WriteJpeg(const std::filesystem::path& path, const render::Image& image) {
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool is_good = CompressJpeg(image, &bytes, &size);
  const std::string content(reinterpret_cast<const char*>(bytes), is_good ? size : 0);
  std::free(bytes);
  if (!is_good) return Unencodable(path, "libjpeg refuses it");
  return host::WriteFile(path, content);
}

base::Status WriteNpy(const std::filesystem::path& path, const std::vector<std::size_t>& shape,
                      std::span<const std::uint8_t> values) {
  std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (";
  for (const std::size_t side : shape) header += std::to_string(side) + ", ";
  header += "), }";
  // magic, version and length take 10 bytes; the whole is a multiple of 64
  header.append((64 - (10 + header.size() + 1) % 64) % 64, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size());
  return host::WriteFile(path, bytes);
}

std::vector<std::uint8_t> MakeMask(const render::GeometryPicture& picture, const PixelTest& test) {
  std::vector<std::uint8_t> mask(picture.labels.size());
  std::transform(picture.labels.begin(), picture.labels.end(), mask.begin(),
                 [&](std::uint16_t label) { return static_cast<std::uint8_t>(test(label) ? 1 : 0); });
  return mask;
}

std::optional<Box> FindBox(const render::GeometryPicture& picture, const PixelTest& test) {
  int x0 = picture.width, x1 = -1, y0 = picture.height, y1 = -1;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (!test(picture.labels[static_cast<std::size_t>(y * picture.width + x)])) continue;
      x0 = std::min(x0, x), x1 = std::max(x1, x);
      y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
  }
  if (x1 < 0) return std::nullopt;
  return Box{x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

std::vector<std::uint32_t> CountRuns(std::span<const std::uint8_t> mask, int width, int height) {
  std::vector<std::uint32_t> runs;
  std::uint8_t value = 0;
  std::uint32_t length = 0;
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) {
      if (mask[static_cast<std::size_t>(y * width + x)] != value) {
        runs.push_back(length);
        length = 0;
        value = static_cast<std::uint8_t>(1 - value);
      }
      ++length;
    }
  }
  runs.push_back(length);
  return runs;
}

}  // namespace trocar::dataset
