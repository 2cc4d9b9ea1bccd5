// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/image.h"

#include <png.h>

#include <cstdlib>

#include "trocar/base/assert.h"
#include "trocar/host/safe_file.h"

namespace trocar::render {
namespace {

constexpr png_uint_32 kMaxSide = 16384;  // pixels; a larger picture is a broken header, not a laparoscope's

}  // namespace

std::array<std::uint8_t, 3> Image::At(int x, int y) const {
  TROCAR_ASSERT(x >= 0 && x < width && y >= 0 && y < height);
  const std::size_t first =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  return {pixels[first], pixels[first + 1], pixels[first + 2]};
}

double CalcMeanDifference(const Image& a, const Image& b) {
  TROCAR_ASSERT(a.width == b.width && a.height == b.height && a.pixels.size() == b.pixels.size());
  if (a.pixels.empty()) return 0.0;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    sum += static_cast<std::uint64_t>(std::abs(int{a.pixels[i]} - int{b.pixels[i]}));
  }
  return static_cast<double>(sum) / static_cast<double>(a.pixels.size());
}

base::Result<std::string> FormatPng(const Image& image) {
  const auto refuse = [](const std::string& why) {
    return base::Error{base::ErrorCode::kFileUnwritable, "the picture cannot be encoded as PNG: " + why};
  };
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() !=
          3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    return refuse("it has " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                  " pixels; draw it before writing");
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;  // a demonstration writes many; a third larger, several times faster
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) == 0) {
    return refuse(png.message);
  }
  bytes.resize(size);
  return bytes;
}

base::Result<Image> ParsePng(std::string_view content, std::string_view source) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto refuse = [&] {
    base::Error error{base::ErrorCode::kImageUndecodable,
                      std::string(source) + " is not a readable PNG: " + png.message + "; write it again"};
    png_image_free(&png);
    return error;
  };
  if (png_image_begin_read_from_memory(&png, content.data(), content.size()) == 0) return refuse();
  if (png.width > kMaxSide || png.height > kMaxSide) {
    const std::string size = std::to_string(png.width) + " x " + std::to_string(png.height);
    png_image_free(&png);
    return base::Error{
        base::ErrorCode::kFileTooLarge,
        std::string(source) + " has " + size + " pixels, more than 16384 a side are not accepted"};
  }
  png.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.pixels.resize(PNG_IMAGE_SIZE(png));
  const png_color black{0, 0, 0};
  if (png_image_finish_read(&png, &black, image.pixels.data(), 0, nullptr) == 0) return refuse();
  return image;
}

base::Status WritePng(const std::filesystem::path& path, const Image& image) {
  auto bytes = FormatPng(image);
  if (!bytes) return bytes.error();
  return host::WriteFile(path, *bytes);
}

}  // namespace trocar::render
