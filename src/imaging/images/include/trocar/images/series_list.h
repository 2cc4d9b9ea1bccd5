// SPDX-License-Identifier: Apache-2.0
/// \file series_list.h  Which series of images a folder or file holds, each with a small picture, before one is chosen.
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace trocar::images {

/// One that ImageSeries::Open(path, options) opens.
struct ListedSeries {
  std::filesystem::path path;
  ImageSeriesOptions options;  ///< what chooses it there: number of the DICOM series or pattern of the names
  std::string description;     ///< "CT, portal venous, acquisition 2", else the name of its file or folder
  std::string format;          ///< as ImageSeriesInfo has it
  std::size_t slices = 0;
  int width = 0, height = 0;           ///< [pixels]
  double pixel_mm = 0, slice_mm = 0;   ///< 0: the files do not say
  bool is_volume = true;               ///< false: a localizer or a single slice
  ColorImage preview;                  ///< of the slice in the middle; empty where it cannot be read
  std::optional<base::Error> problem;  ///< why it cannot be opened as it is
};

inline constexpr int kPreviewSide = 120;  ///< longer side of a preview [pixels]

/// DICOM series, volumes and stacks of numbered pictures of a folder and the folders in it (three deep), or the one of a file. A
/// DICOM file stands for its folder. Files that are none of it are passed over.
/// \return kImageFolderMissing; kImageSliceMissing where there is no image at all; kCancelled
/// \note Decodes every volume and a slice of each series: not on a window's thread.
base::Result<std::vector<ListedSeries>> ListSeries(const std::filesystem::path& path,
                                                   const Progress& progress = {},
                                                   const std::stop_token& stop = {});

}  // namespace trocar::images
