// SPDX-License-Identifier: Apache-2.0
/// \file slice_names.h  Numbered pictures of a folder: which files are one stack, and how a slice's file is
/// named.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::images {

/// The numbered pictures of a folder.
struct NamedSlices {
  std::string pattern;               ///< "image-{slice:04}.jpeg"
  std::map<int, std::string> files;  ///< name by slice number
  std::size_t ignored = 0;           ///< other files
};

/// Whether the name ends like a JPEG, PNG or TIFF file (in any case of letters).
bool IsPictureName(std::string_view name);

/// File name of a slice: "{slice:04}" in the pattern becomes the number with leading zeros, "{slice}" the
/// bare number.
std::string FormatImageName(std::string_view pattern, int slice);

/// Finds the pictures whose names differ in their last number only, or those of a given pattern.
///
/// \param names    files of one folder, in any order
/// \param pattern  as FormatImageName reads it; empty: find it
/// \return kImageSliceMissing when there is none, kImageSeriesMixed when there are several stacks (with
///         their patterns), kImageSeriesUneven for a number that comes twice
base::Result<NamedSlices> FindNamedSlices(std::span<const std::string> names, const std::string& pattern);

/// Checks that the numbers ascend in equal steps.
/// \return the step; kImageSeriesGap naming the missing numbers
base::Result<int> CheckSliceNumbers(std::span<const int> numbers);

}  // namespace trocar::images
