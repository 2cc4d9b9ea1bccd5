// SPDX-License-Identifier: Apache-2.0
/// \file device_page_picture_check.cpp  Judges the picture of `trocar-window --devices`: a curve in each lane of the plot.
#include <cstdio>
#include <vector>

#include "trocar_test/window_picture.h"

using trocar::test::Fail;

int main(int argc, char** argv) {
  if (argc != 2) return Fail("usage: device_page_picture_check PICTURE.png");
  const trocar::test::WindowPicture image = trocar::test::ReadWindowPicture(argv[1]);
  // the right part, behind the names: blue pan, green tilt, violet turn, yellow depth
  int pan = 0, tilt = 0, turn = 0, depth = 0;
  for (unsigned y = 40; y < image.height - 40; ++y) {
    for (unsigned x = image.width * 55 / 100; x < image.width - 10; ++x) {
      const unsigned char* p = image.At(x, y);
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
