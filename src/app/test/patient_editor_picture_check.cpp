// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_picture_check.cpp  Judges the picture of `trocar-window --edit-patient`.
#include <png.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

int Fail(const char* text) {
  std::fprintf(stderr, "%s\n", text);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return Fail("usage: patient_editor_picture_check PICTURE.png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, argv[1])) return Fail("the picture cannot be read");
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr))
    return Fail("the picture cannot be decoded");
  if (image.width < 1000 || image.height < 600) return Fail("the picture is smaller than the window");
  // the left part shows the liver with its regions: blue face, yellow falciform, brown rest
  int blue = 0, yellow = 0, brown = 0;
  for (unsigned y = 60; y < image.height - 60; ++y) {
    for (unsigned x = 10; x < image.width * 3 / 5; ++x) {
      const unsigned char* p = &pixels[3 * (std::size_t(y) * image.width + x)];
      blue += p[2] > 120 && p[2] > p[0] + 50;
      yellow += p[0] > 150 && p[1] > 110 && p[2] < 110;
      brown += p[0] > 70 && p[0] > p[1] + 35 && p[1] < 110;
    }
  }
  const int all = static_cast<int>(image.width * image.height);
  if (blue < all / 50) return Fail("the diaphragmatic face is not blue");
  if (yellow < all / 500) return Fail("the falciform is not yellow");
  if (brown < all / 50) return Fail("the liver's other surface is not brown");
  return 0;
}
