// SPDX-License-Identifier: Apache-2.0
/// \file window_picture_check.cpp  Judges the picture and the report of `trocar-window --screenshot`.
#include <png.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "trocar/core/safe_file.h"

namespace {

int Fail(const char* text) {
  std::fprintf(stderr, "%s\n", text);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return Fail("usage: window_picture_check PICTURE.png REPORT.json");
  const auto text = trocar::core::ReadFile(argv[2]);
  if (!text) return Fail(text.error().Text().c_str());
  // the session's helpers may have written lines of their own
  const std::size_t begin = text.value().find("{\"screenshot\""), end = text.value().find('}', begin);
  if (begin == std::string::npos || end == std::string::npos) return Fail("there is no report");
  const nlohmann::json report =
      nlohmann::json::parse(text.value().substr(begin, end - begin + 1), nullptr, false);
  if (report.is_discarded()) return Fail("the report is no JSON");
  if (report.at("ticks").get<int>() < 200) return Fail("two seconds are at least 200 ticks of 1/120 s");
  if (report.at("pictures").get<int>() < 2) return Fail("fewer than 2 pictures were drawn");

  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, argv[1])) return Fail("the picture cannot be read");
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr))
    return Fail("the picture cannot be decoded");
  if (image.width < 1000 || image.height < 600) return Fail("the picture is smaller than the window");

  // the middle of the laparoscope's picture shows tissue: red over blue, in many shades
  std::set<int> shades;
  int tissue = 0, all = 0;
  for (unsigned y = image.height / 4; y < image.height * 3 / 4; ++y) {
    for (unsigned x = image.width / 6; x < image.width * 11 / 20; ++x) {
      const unsigned char* pixel = &pixels[3 * (std::size_t(y) * image.width + x)];
      shades.insert(pixel[0] << 16 | pixel[1] << 8 | pixel[2]);
      tissue += pixel[0] > 40 && pixel[0] > pixel[2] + 15;
      ++all;
    }
  }
  if (shades.size() < 500) return Fail("the laparoscope's picture is nearly empty: fewer than 500 colours");
  if (tissue < all / 4) return Fail("less than a quarter of the laparoscope's picture shows tissue");
  return 0;
}
