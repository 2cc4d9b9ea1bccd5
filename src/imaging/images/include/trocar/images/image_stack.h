// SPDX-License-Identifier: Apache-2.0
/// \file image_stack.h  Pictures and label volumes, decoded.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::images {

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

/// Decodes one JPEG, PNG or TIFF picture of 8 bits, grey or colour, in a process of its own.
///
/// \return kFileMissing, kImagePathUnsafe, kImageTruncated, kImageTooLarge (more than 16384 x 16384 pixels),
///         kImageUnsupported or kImageUndecodable
base::Result<ColorImage> ReadImage(const std::filesystem::path& path);

/// Largest value of a voxel in a label map.
inline constexpr std::int32_t kLargestLabel = 2147483647;

/// Integer labels on a grid.
struct LabelVolume {
  std::array<int, 3> size = {0, 0, 0};                  ///< voxels, first axis fastest
  std::array<std::array<double, 3>, 3> direction = {};  ///< [axis] step of one voxel, LPS [mm]
  std::array<double, 3> origin = {0, 0, 0};             ///< centre of the first voxel, LPS [mm]
  std::vector<std::int32_t> labels;                     ///< (size product), 0 to kLargestLabel
  std::vector<std::pair<std::string, int>> names;       ///< of labels, where the file has them
  /// Codes of labels in SNOMED CT or its predecessor SRT, where the file has them: "10200004", "T-62000"; with the side behind,
  /// "64033007 24028007"; with the region behind "@", for something that has changed an organ, "108369006 @10200004".
  std::vector<std::pair<std::string, int>> codes;
};

/// Reads a label map (NIfTI, NRRD, MetaImage) of whole numbers from 0 to kLargestLabel, those of 64 bits or floating point
/// up to 2^24, in a process of its own, with the names of labels that 3D Slicer and TotalSegmentator put into headers.
///
/// \param path  label map, or a folder with masks named liver and gallbladder (.nii.gz, .nii, .nrrd or .mha), which
///              become the labels 1 and 2; masks named as neighbours (roles.h), vertebrae_L3 and vertebrae_L4 come along
/// \return kFileMissing; kImageUndecodable for what is no label map; kImageSpacingUnknown where the file does
/// not
///         say how it lies in the body; kImageTooLarge for more than 2^28 voxels; and what docs/images.md
///         lists; kLabelsMismatch for masks that do not lie alike
base::Result<LabelVolume> ReadLabelVolume(const std::filesystem::path& path);

}  // namespace trocar::images
