// SPDX-License-Identifier: Apache-2.0
/// \file dicom_series.h  Single DICOM slices become a series: sorted by position, brought to even distances, refused when they do not
/// belong together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "import_protocol.h"
#include "trocar/base/result.h"
#include "trocar/math/vector.h"

namespace trocar::images {

/// One picture: a file, or a frame of one.
struct DicomSlice {
  std::string file;
  ImageHeader header;        ///< of this picture only: its depth is 1
  std::uint32_t frame = 0;   ///< within the file
  std::uint32_t frames = 1;  ///< that the file holds
};

/// Where a slice of even distances lies between those of uneven ones.
struct SlicePlace {
  std::size_t below = 0;  ///< index into DicomOrder::slices
  double part = 0;        ///< of the one above [0, 1); 0: that slice as it is
};

/// How slices follow each other.
struct DicomOrder {
  std::vector<std::size_t> slices;  ///< indices into the input, by ascending slice number
  std::vector<int> numbers;         ///< ascending by 1; of `places` where there are any, else of `slices`
  std::vector<SlicePlace> places;   ///< where distances change; else empty
  double slice_mm = 0;              ///< 0 for a single slice
  math::Vec3 direction;             ///< in which the slice number grows, unit vector, LPS
  std::string note;                 ///< what was done to the slices, for a person; empty where nothing was
};

/// A text that a person reads beside what was opened. tests/texts lists the patterns of its calls, as it does those of errors.
inline std::string Note(std::string text) {
  return text;
}

/// "slice 12 (IM000012)"
std::string NameSlice(const DicomSlice& slice);

/// Reason why two slices cannot be of one volume ("are of two series"); null where there is none.
const char* FindDifference(const ImageHeader& a, const ImageHeader& b);

/// Sorts by position along the normal. Slice numbers are the instance numbers where these run along with the
/// positions, else 1, 2, ... from the lowest position (inferior, right or anterior) on.
///
/// Where the distance changes from one stretch of slices to the next (each of three distances at least), slices at the smallest
/// distance are interpolated.
///
/// \return kImageSeriesMixed (patients, series, sizes, kinds of pixels, orientations), kImageSeriesGap or
///         kImageSeriesUneven with slice numbers and files; kImageGeometryInvalid where a file does not say
///         where it lies
base::Result<DicomOrder> OrderDicomSlices(std::span<const DicomSlice> slices);
/// As above, from pointers; the order holds indices into them.
base::Result<DicomOrder> OrderDicomSlices(std::span<const DicomSlice* const> slices);

/// The place of each slice along the normal: 0, 1, ... from the lowest one on; slices in one place have the same.
std::vector<std::size_t> FindPlaces(std::span<const DicomSlice* const> slices);

/// A slice of `others` that lies where `order` says that one is missing, and why it is none of the volume.
std::optional<base::Error> FindStrayInGap(std::span<const DicomSlice> volume,
                                          std::span<const DicomSlice> others);

}  // namespace trocar::images
