// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"

namespace trocar::images {
namespace {

constexpr int kGap = 4;    // pixels between tiles
constexpr int kScale = 3;  // of a digit's dots

/// Digits of 3 x 5 dots, a row each, most significant bit left.
constexpr std::array<std::array<std::uint8_t, 5>, 10> kDigits = {{{7, 5, 5, 5, 7},
                                                                  {2, 6, 2, 2, 7},
                                                                  {7, 1, 7, 4, 7},
                                                                  {7, 1, 7, 1, 7},
                                                                  {5, 5, 7, 1, 1},
                                                                  {7, 4, 7, 1, 7},
                                                                  {7, 4, 7, 5, 7},
                                                                  {7, 1, 1, 1, 1},
                                                                  {7, 5, 7, 5, 7},
                                                                  {7, 5, 7, 1, 7}}};

void FillBox(ColorImage& sheet, int x0, int y0, int width, int height, std::uint8_t shade) {
  for (int y = std::max(0, y0); y < std::min(sheet.height, y0 + height); ++y) {
    for (int x = std::max(0, x0); x < std::min(sheet.width, x0 + width); ++x)
      std::fill_n(sheet.At(x, y), 3, shade);
  }
}

/// White digits on a black box.
void DrawNumber(ColorImage& sheet, int x0, int y0, int number) {
  const std::string digits = std::to_string(number);
  FillBox(sheet, x0, y0, kScale * (4 * static_cast<int>(digits.size()) + 1), kScale * 7, 0);
  for (std::size_t i = 0; i < digits.size(); ++i) {
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 3; ++column) {
        if ((kDigits[static_cast<std::size_t>(digits[i] - '0')][static_cast<std::size_t>(row)] >>
                 (2 - column) &
             1) == 0)
          continue;
        FillBox(sheet, x0 + kScale * (1 + 4 * static_cast<int>(i) + column), y0 + kScale * (1 + row), kScale,
                kScale, 255);
      }
    }
  }
}

/// Mean of the pixels that fall onto each smaller one.
void DrawReduced(const ColorImage& picture, ColorImage& sheet, int x0, int y0, int width, int height) {
  for (int y = 0; y < height; ++y) {
    const int top = y * picture.height / height,
              bottom = std::max(top + 1, (y + 1) * picture.height / height);
    for (int x = 0; x < width; ++x) {
      const int left = x * picture.width / width, right = std::max(left + 1, (x + 1) * picture.width / width);
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int v = top; v < bottom; ++v) {
          for (int u = left; u < right; ++u) sum += picture.At(u, v)[c];
        }
        sheet.At(x0 + x, y0 + y)[c] = static_cast<std::uint8_t>(sum / ((bottom - top) * (right - left)));
      }
    }
  }
}

}  // namespace

base::Result<ColorImage> DrawContactSheet(const ImageSeries& series, const DisplayWindow& window,
                                          const ContactSheetSettings& settings, const Progress& progress) {
  TROCAR_ASSERT(settings.columns >= 1 && settings.columns <= 20 && settings.rows >= 1 && settings.rows <= 20);
  TROCAR_ASSERT(settings.tile >= 40 && settings.tile <= 1000);
  const ImageSeriesInfo& info = series.Info();
  const std::size_t present = info.slice_numbers.size();
  const std::size_t shown = std::min(present, static_cast<std::size_t>(settings.columns * settings.rows));
  std::vector<int> numbers;
  for (std::size_t i = 0; i < shown; ++i)
    numbers.push_back(info.slice_numbers[shown > 1 ? i * (present - 1) / (shown - 1) : 0]);
  const auto pictures = ReadSlices(series, numbers, window, progress);
  if (!pictures) return pictures.error();

  const double scale = static_cast<double>(settings.tile) / std::max(info.width, info.height);
  const int width = std::max(1, base::TruncateTo<int>(info.width * scale));
  const int height = std::max(1, base::TruncateTo<int>(info.height * scale));
  const int columns =
      static_cast<int>(std::min<std::size_t>(shown, static_cast<std::size_t>(settings.columns)));
  const int rows = (static_cast<int>(shown) + columns - 1) / columns;
  ColorImage sheet{columns * (width + kGap) + kGap, rows * (height + kGap) + kGap, {}};
  sheet.samples.assign(static_cast<std::size_t>(sheet.width) * sheet.height * 3, 64);
  for (std::size_t i = 0; i < shown; ++i) {
    const int x0 = kGap + static_cast<int>(i) % columns * (width + kGap);
    const int y0 = kGap + static_cast<int>(i) / columns * (height + kGap);
    DrawReduced(pictures->at(numbers[i]), sheet, x0, y0, width, height);
    DrawNumber(sheet, x0, y0, numbers[i]);
  }
  return sheet;
}

}  // namespace trocar::images
