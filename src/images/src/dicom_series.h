// SPDX-License-Identifier: Apache-2.0
/// \file dicom_series.h  Single DICOM slices become a series: sorted by position, refused when they do not
/// belong together.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "import_protocol.h"
#include "trocar/core/result.h"
#include "trocar/math/vector.h"

namespace trocar::images {

/// One file of a folder.
struct DicomSlice {
  std::string file;
  ImageHeader header;
};

/// How slices follow each other.
struct DicomOrder {
  std::vector<std::size_t> slices;  ///< indices into the input, by ascending slice number
  std::vector<int> numbers;         ///< ascending by 1
  double slice_mm = 0;              ///< 0 for a single slice
  math::Vec3 direction;             ///< in which the slice number grows, unit vector, LPS
};

/// Slices by series, in the order of their first file; slices of one series stay in order.
std::vector<std::vector<DicomSlice>> SplitSeries(std::span<const DicomSlice> slices);

/// Sorts by position along the normal. Slice numbers are the instance numbers where these run along with the
/// positions, else 1, 2, ... from the lowest position (inferior, right or anterior) on.
///
/// \return kImageSeriesMixed (patients, series, sizes, kinds of pixels, orientations), kImageSeriesGap or
///         kImageSeriesUneven with slice numbers and files; kImageGeometryInvalid where a file does not say
///         where it lies
core::Result<DicomOrder> OrderDicomSlices(std::span<const DicomSlice> slices);

}  // namespace trocar::images
