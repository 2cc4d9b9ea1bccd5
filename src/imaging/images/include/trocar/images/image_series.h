// SPDX-License-Identifier: Apache-2.0
/// \file image_series.h  Any stack of cross-sections (DICOM, NIfTI, NRRD, MetaImage, PNG, JPEG, TIFF) seen in
/// one way: numbered slices of square pixels, with their size in millimetres and how they lie in the patient.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"

namespace trocar::images {

/// Window and level, in the file's grey values (HU for CT): `centre` is shown as mid-grey, `width` spans
/// black to white.
struct DisplayWindow {
  double centre = 127.5;
  double width = 255.0;  ///< > 0
};

/// Properties of an open series.
struct ImageSeriesInfo {
  std::string format;              ///< "DICOM", "NIfTI", "NRRD", "MetaImage", "JPEG", "PNG" or "TIFF"
  int width = 0, height = 0;       ///< of every picture that ReadSlice gives [pixels]
  std::vector<int> slice_numbers;  ///< ascending in equal steps, as contour files name them
  double pixel_mm = 0;             ///< side of a square pixel
  double slice_mm = 0;             ///< between slice number n and n + 1
  /// Patient directions in which column, row and slice number grow: "left", "posterior", "superior", ...
  std::array<std::string, 3> axes;
  std::string file_frame;  ///< "LPS" or "RAS": what the file said; empty if it said nothing
  bool is_color = false;
  int bits = 8;                                 ///< of one sample in the file
  std::array<double, 2> grey_range = {0, 255};  ///< least and greatest value found
  DisplayWindow suggested_window;
  std::array<double, 3> origin_mm = {0, 0, 0};  ///< centre of the first slice's first pixel, LPS
  /// [column, row, slice number] unit vectors, LPS
  std::array<std::array<double, 3>, 3> direction = {};
  double tilt_deg = 0;            ///< largest angle between an axis and the patient direction that names it
  std::string pattern;            ///< of a stack of pictures: "image-{slice:04}.jpeg"; else empty
  std::size_t ignored_files = 0;  ///< in the folder, that are no part of the series
  int series = 0,
      series_id = 0;  ///< of a DICOM volume: what ImageSeriesOptions::series chooses it by; else 0
  /// Remarks for a person on how it was read: why this series was taken, what was passed over, what was interpolated.
  std::vector<std::string> notes;
};

/// Properties that a person gives where the files lack them, and limits of the import. Where a file does state
/// one, the value given here must agree.
struct ImageSeriesOptions {
  std::optional<double> pixel_mm;  ///< side of a square pixel, 0.01 to 20
  std::optional<double> slice_mm;  ///< between slice number n and n + 1, 0.01 to 50
  /// Where column, row and slice number grow to, one each of left/right, superior/inferior and
  /// anterior/posterior. For files that do not say it.
  std::optional<std::array<std::string, 3>> axes;
  std::string pattern;      ///< only files with such names: "image-{slice:04}.jpeg"; empty: find it
  std::vector<int> slices;  ///< only these numbers, ascending; empty: all, which must have no gaps
  int series =
      0;  ///< of several DICOM series or parts in a folder: number or id; 0: one must be the only volume
  std::size_t memory_bytes = std::size_t{2} << 30;  ///< most that the decoded series may take
};

/// An open series. Pictures of a stack are decoded when asked for; volumes are held once.
/// Copies share what they hold.
class ImageSeries {
 public:
  /// \param path  DICOM folder or file, folder of numbered pictures, or a volume (.nii, .nii.gz, .nrrd,
  ///              .nhdr, .mha, .mhd, .tif)
  /// \return kImageFolderMissing; kImageSpacingUnknown with the options to give; kImageSeriesMixed,
  ///         kImageSeriesGap or kImageSeriesUneven with the slice numbers or files concerned; and what
  ///         docs/images.md lists for damaged files. No file can crash this program: strangers' files are
  ///         decoded by processes of their own.
  /// \note Safe in a program with threads. Progress is called from the calling thread.
  static base::Result<ImageSeries> Open(const std::filesystem::path& path,
                                        const ImageSeriesOptions& options = {},
                                        const Progress& progress = {});

  const ImageSeriesInfo& Info() const;

  /// One slice as a picture. Colour series ignore the window.
  ///
  /// \param number  one of Info().slice_numbers
  /// \return kImageSliceMissing for another number, or why it cannot be decoded
  /// \note Thread-safe.
  base::Result<ColorImage> ReadSlice(int number, const DisplayWindow& window) const;

  struct Content;  ///< of image_series.cpp

 private:
  explicit ImageSeries(std::shared_ptr<const Content> content);
  std::shared_ptr<const Content> content_;  // shared: a view and a background build may outlive each other
};

/// Several slices as pictures, decoded in parallel.
///
/// \param numbers  ascending
/// \return picture by slice number; or the error of the lowest slice that has one, with its number
base::Result<std::map<int, ColorImage>> ReadSlices(const ImageSeries& series, std::span<const int> numbers,
                                                   const DisplayWindow& window,
                                                   const Progress& progress = {});

}  // namespace trocar::images
