// SPDX-License-Identifier: Apache-2.0
/// \file image_stack.h  Cross-sectional photographs and label volumes, decoded.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/core/result.h"

namespace trocar::anatomy {

/// Told now and then what is being done and how much of it is done [0, 1]. May be empty. Called from one
/// thread.
using Progress = std::function<void(std::string_view what, double fraction)>;

/// Colour picture, rows from top to bottom.
struct ColorImage {
  int width = 0, height = 0;          ///< [pixels]
  std::vector<std::uint8_t> samples;  ///< (height * width * 3) red, green, blue

  const std::uint8_t* At(int x, int y) const {
    return &samples[3 * (static_cast<std::size_t>(y) * width + x)];
  }
  std::uint8_t* At(int x, int y) { return &samples[3 * (static_cast<std::size_t>(y) * width + x)]; }
};

/// Decodes a JPEG or PNG file (grey or colour, 8 bits). The size in the header is checked before anything is
/// decoded.
///
/// \return kFileMissing, or kImageUndecodable for what is no whole picture or larger than 16384 x 16384
core::Result<ColorImage> ReadImage(const std::filesystem::path& path);

/// A folder of slices named by number.
struct SliceFolder {
  std::filesystem::path folder;
  std::string pattern;        ///< "image-{slice:04}.jpeg"
  int width = 0, height = 0;  ///< what every slice must measure [pixels]
};

/// Decodes the named slices, in parallel.
///
/// \param slices  numbers, ascending; only these files are opened
/// \return picture by slice number; kImageFolderMissing, or for the lowest offending slice
/// kImageSliceMissing,
///         kImageSizeDiffers or kImageUndecodable, with its number
core::Result<std::map<int, ColorImage>> LoadSlices(const SliceFolder& source, std::span<const int> slices,
                                                   const Progress& progress = {});

/// Integer labels on a grid.
struct LabelVolume {
  std::array<int, 3> size = {0, 0, 0};                  ///< voxels, first axis fastest
  std::array<std::array<double, 3>, 3> direction = {};  ///< [axis] step of one voxel, LPS [mm]
  std::array<double, 3> origin = {0, 0, 0};             ///< centre of the first voxel, LPS [mm]
  std::vector<std::uint8_t> labels;                     ///< (size product)
  std::vector<std::pair<std::string, int>> names;       ///< of labels, where the file has them (3D Slicer)
};

/// Reads a NIfTI (.nii, .nii.gz) or NRRD (.nrrd, .nhdr) label map of whole numbers from 0 to 255, with the
/// segment names that 3D Slicer puts into NRRD headers.
/// \return kFileMissing, or kImageUndecodable for what is no label map, has more than 2^28 voxels, or is too
/// small a file for the size in its header (checked before anything is allocated)
core::Result<LabelVolume> ReadLabelVolume(const std::filesystem::path& path);

}  // namespace trocar::anatomy
