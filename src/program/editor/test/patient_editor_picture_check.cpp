// SPDX-License-Identifier: Apache-2.0
/// \file patient_editor_picture_check.cpp  Judges the picture of `trocar-window --edit-patient`.
#include <cmath>
#include <cstdio>
#include <vector>

#include "trocar_test/window_picture.h"

using trocar::test::Fail;

int main(int argc, char** argv) {
  if (argc != 2) return Fail("usage: patient_editor_picture_check PICTURE.png");
  const trocar::test::WindowPicture image = trocar::test::ReadWindowPicture(argv[1]);
  // the left part shows the liver with its regions: blue face, yellow falciform, brown rest
  int blue = 0, yellow = 0, brown = 0;
  for (unsigned y = 60; y < image.height - 60; ++y) {
    for (unsigned x = 10; x < image.width * 3 / 5; ++x) {
      const unsigned char* p = image.At(x, y);
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
