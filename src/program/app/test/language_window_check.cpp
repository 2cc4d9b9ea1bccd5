// SPDX-License-Identifier: Apache-2.0
/// \file language_window_check.cpp  Whether the header bar of a window says something else in another language, and the same in the
/// same one.
#include "trocar_test/window_picture.h"

namespace {

constexpr unsigned kBar = 44;            // height of the header bar [pixels]
constexpr int kSameAtMost = 40;          // pixels of a caret or a focus ring
constexpr int kDifferentAtLeast = 1500;  // half a dozen of words

int CountDifferent(const trocar::test::WindowPicture& a, const trocar::test::WindowPicture& b) {
  int count = 0;
  for (unsigned y = 0; y < kBar; ++y) {
    for (unsigned x = 0; x < a.width; ++x) {
      const unsigned char *p = a.At(x, y), *q = b.At(x, y);
      count += std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) + std::abs(p[2] - q[2]) > 48 ? 1 : 0;
    }
  }
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  using trocar::test::Fail;
  if (argc != 4) return Fail("usage: language_window_check ENGLISH.png ENGLISH_AGAIN.png SPANISH.png");
  const auto english = trocar::test::ReadWindowPicture(argv[1]),
             again = trocar::test::ReadWindowPicture(argv[2]),
             spanish = trocar::test::ReadWindowPicture(argv[3]);
  if (english.width != spanish.width || english.height != spanish.height || again.width != english.width)
    return Fail("the windows differ in size: the Spanish texts do not fit");
  const int same = CountDifferent(english, again), different = CountDifferent(english, spanish);
  std::printf("English again: %d pixels differ; Spanish: %d\n", same, different);
  if (same > kSameAtMost) return Fail("the header bar is another one each time");
  if (different < kDifferentAtLeast) return Fail("the header bar is not Spanish");
  return 0;
}
