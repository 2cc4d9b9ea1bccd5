// SPDX-License-Identifier: Apache-2.0
/// \file window_picture.h  What `--screenshot` saved, for the programs that judge it.
#pragma once

#include <png.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace trocar::test {

/// Says what is wrong. \return the exit status of a check that failed
inline int Fail(const std::string& text) {
  std::fprintf(stderr, "%s\n", text.c_str());
  return 1;
}

/// Pixels from the top left, red, green and blue.
struct WindowPicture {
  unsigned width = 0, height = 0;
  std::vector<unsigned char> pixels;

  const unsigned char* At(unsigned x, unsigned y) const {
    return &pixels[3 * (static_cast<std::size_t>(y) * width + x)];
  }
  /// How many pixels from (x0, y0) to before (x1, y1) are such.
  template <typename Is>
  int Count(unsigned x0, unsigned y0, unsigned x1, unsigned y1, Is is) const {
    int count = 0;
    for (unsigned y = y0; y < y1; ++y) {
      for (unsigned x = x0; x < x1; ++x) count += is(At(x, y)) ? 1 : 0;
    }
    return count;
  }
};

/// Ends the check, with a word, where there is no picture of a whole window.
inline WindowPicture ReadWindowPicture(const char* path) {
  const auto give_up = [](const char* text) { std::exit(Fail(text)); };
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path)) give_up("the picture cannot be read");
  image.format = PNG_FORMAT_RGB;
  WindowPicture picture{image.width, image.height, std::vector<unsigned char>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr))
    give_up("the picture cannot be decoded");
  if (picture.width < 1000 || picture.height < 600) give_up("the picture is smaller than the window");
  return picture;
}

}  // namespace trocar::test
