// SPDX-License-Identifier: Apache-2.0
/// \file device_page_picture_check.cpp  Judges the picture of `trocar-window --devices`: a curve in each lane of the plot.
#include <png.h>

#include <cstdio>
#include <vector>

namespace {

int Fail(const char* text) {
  std::fprintf(stderr, "%s\n", text);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return Fail("usage: device_page_picture_check PICTURE.png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, argv[1])) return Fail("the picture cannot be read");
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr))
    return Fail("the picture cannot be decoded");
  if (image.width < 1000 || image.height < 600) return Fail("the picture is smaller than the window");
  // the right part, behind the names: blue pan, green tilt, violet turn, yellow depth
  int pan = 0, tilt = 0, turn = 0, depth = 0;
  for (unsigned y = 40; y < image.height - 40; ++y) {
    for (unsigned x = image.width * 55 / 100; x < image.width - 10; ++x) {
      const unsigned char* p = &pixels[3 * (std::size_t(y) * image.width + x)];
      const int r = p[0], g = p[1], b = p[2];
      pan += b > 150 && g > 140 && r < g - 40;
      tilt += g > 150 && g > r + 40 && g > b + 30;
      turn += b > 160 && b > g + 30 && r > g + 10;
      depth += r > 170 && g > 120 && g < r && b < 130;
    }
  }
  if (pan < 100) return Fail("no curve of the pan");
  if (tilt < 100) return Fail("no curve of the tilt");
  if (turn < 100) return Fail("no curve of the turn");
  if (depth < 100) return Fail("no curve of the depth");
  return 0;
}
