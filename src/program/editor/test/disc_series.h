// SPDX-License-Identifier: Apache-2.0
/// \file disc_series.h  Pictures for tests: five slices of a bright disc of 30 pixels about (60, 50).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "trocar/contours/contour_workspace.h"
#include "trocar/images/image_series.h"
#include "trocar/images/png_file.h"

namespace trocar::editor {

inline void WriteDisc(const std::filesystem::path& folder) {
  for (int slice = 1; slice <= 5; ++slice) {
    images::ColorImage image{120, 100, std::vector<std::uint8_t>(120 * 100 * 3, 40)};
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 120; ++x) {
        const double inside = std::clamp(30.5 - std::hypot(x - 60.0, y - 50.0), 0.0, 1.0);
        for (int c = 0; c < 3; ++c) image.At(x, y)[c] = static_cast<std::uint8_t>(40 + 160 * inside);
      }
    }
    EXPECT_TRUE(images::WritePng(folder / ("s" + std::to_string(slice) + ".png"), image).ok());
  }
}

/// What the pictures do not say.
inline images::ImageSeriesOptions DiscSeries() {
  images::ImageSeriesOptions series;
  series.pixel_mm = 0.5, series.slice_mm = 2;
  series.axes = {"left", "posterior", "inferior"};
  return series;
}

/// New contours on them.
inline base::Result<contours::ContourWorkspace> OpenDisc(const std::filesystem::path& folder) {
  WriteDisc(folder);
  contours::WorkspaceOptions options;
  options.images = folder;
  options.series = DiscSeries();
  return contours::ContourWorkspace::Open(options);
}

}  // namespace trocar::editor
