// SPDX-License-Identifier: Apache-2.0
/// \file series_geometry.h  Size and place of a series, from what its files say and what a person adds.
#pragma once

#include <array>
#include <cstddef>

#include "import_protocol.h"
#include "trocar/base/result.h"
#include "trocar/images/image_series.h"
#include "trocar/math/vector.h"

namespace trocar::images {

/// Size and place as the files state them; unknown where they state nothing.
struct SaidGeometry {
  double spacing[2] = {0, 0};  // of columns and rows [mm]
  double slice_mm = 0;
  bool has_direction = false;
  std::array<math::Vec3, 3> direction;
  math::Vec3 origin;
};

/// Geometry that one header states.
SaidGeometry GeometryOf(const ImageHeader& header);

/// Fills in size, spacing and axes of the pictures that come out.
/// \return kImageSpacingUnknown naming what is to be given, or kImageGeometryInvalid
base::Status SetGeometry(const SaidGeometry& said, const ImageHeader& header,
                         const ImageSeriesOptions& options, ImageSeriesInfo& info);

/// Format and frame, by the names that people know.
const char* FormatName(FileKind kind);
const char* FrameName(FileFrame frame);

/// Kind of samples, grey range and suggested window, from `count` samples.
void SetGreyValues(const ImageHeader& header, const std::byte* samples, std::size_t count,
                   ImageSeriesInfo& info);
/// Of a volume of stored slices, each of which may have a scale of its own.
void SetGreyValues(const ImageSeries::Content& content, ImageSeriesInfo& info);

}  // namespace trocar::images
