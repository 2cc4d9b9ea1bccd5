// SPDX-License-Identifier: Apache-2.0
/// \file series_form.h  Form in which a person gives size and orientation of pictures that do not state them.
#pragma once

#include <array>
#include <span>
#include <string>

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace trocar::editor {

/// Texts as they stand in the fields. Empty: left to the files.
struct SeriesForm {
  std::string pixel_mm;             ///< side of a pixel [mm]
  std::string slice_mm;             ///< from one slice number to the next [mm]
  std::array<std::string, 3> axes;  ///< where columns, rows and slice numbers grow to: of PatientDirections
};

/// left, right, anterior, posterior, superior, inferior.
std::span<const char* const> PatientDirections() noexcept;

/// Form with what is known already, as texts.
SeriesForm MakeSeriesForm(const images::ImageSeriesOptions& series);

/// \param series  what else is known; sizes and axes are replaced
/// \return kUsage with the field that is wrong: lengths are 0.01 to 20 and 0.01 to 50 mm, with a decimal point or
///         comma; of the axes all or none are given, in three different directions
base::Result<images::ImageSeriesOptions> ReadSeriesForm(const SeriesForm& form,
                                                        images::ImageSeriesOptions series);

}  // namespace trocar::editor
