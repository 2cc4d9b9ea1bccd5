// SPDX-License-Identifier: Apache-2.0
/// \file contact_sheet.h  Slices of a series side by side in one picture, each with its number.
#pragma once

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace trocar::images {

struct ContactSheetSettings {
  int columns = 5, rows = 4;  ///< 1 to 20
  int tile = 240;             ///< longer side of one slice [pixels], 40 to 1000
};

/// Evenly chosen slices of the series, the first and the last among them, in the order of their numbers.
///
/// \param window  for grey series
/// \return the error of the lowest slice that cannot be read
base::Result<ColorImage> DrawContactSheet(const ImageSeries& series, const DisplayWindow& window,
                                          const ContactSheetSettings& settings = {},
                                          const Progress& progress = {});

}  // namespace trocar::images
