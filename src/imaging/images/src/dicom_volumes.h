// SPDX-License-Identifier: Apache-2.0
/// \file dicom_volumes.h  The volumes in a folder of DICOM slices: series, and the parts of series that hold several (phases, echoes,
/// a localizer). Slices that are one volume as they lie are never parted by what their headers say beside that.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "dicom_series.h"
#include "trocar/base/result.h"

namespace trocar::images {

struct DicomVolume {
  /// 1, 2, ...: the first volume of each series, in the order of the series' first files; then further ones of series that hold several.
  /// Series of pictures without a place count, too: people have kept numbers from before those were passed over.
  int number = 0;
  int id = 0;  ///< six to nine digits made of what it is: the same whatever else lies in the folder
  std::string
      part;  ///< what sets it apart in its series ("acquisition 2"); empty where the series is one volume
  std::vector<DicomSlice> slices;
  base::Result<DicomOrder> order = base::Error{};
  /// Whether a person may have meant it: several places, and no localizer.
  bool is_volume = false;
};

/// \param slices     that have a place, in the order of their files
/// \param placeless  pictures without a place, whose series have numbers and no volumes
std::vector<DicomVolume> SplitVolumes(std::span<const DicomSlice> slices,
                                      std::span<const DicomSlice> placeless = {});

/// "CT, Portal venous, acquisition 2: 24 slices"
std::string DescribeVolume(const DicomVolume& volume);

/// The one of this number or id; of number 0, the only one that is a volume.
/// \param[out] note  why it was taken, where there are others and nobody chose; else empty
/// \return index; kImageSeriesMixed with the list to choose from, or kImageSliceMissing for a number that there is not
base::Result<std::size_t> ChooseVolume(std::span<const DicomVolume> volumes, int number, std::string& note);

}  // namespace trocar::images
