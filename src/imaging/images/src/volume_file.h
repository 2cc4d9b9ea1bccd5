// SPDX-License-Identifier: Apache-2.0
/// \file volume_file.h  One image file, whole, decoded by a reader process.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "import_worker.h"
#include "trocar/base/result.h"
#include "trocar/images/image_series.h"

namespace trocar::images {

/// Samples as the file has them, first axis fastest, channels interleaved.
struct DecodedFile {
  ImageHeader header;
  SampleBuffer samples;
  std::vector<SegmentName> names;  ///< of labels, where the file has them
};

/// The header of a pair of files, a.hdr, where a person named the one with its samples, a.img; else the path itself.
std::filesystem::path FindHeader(const std::filesystem::path& path);

/// \param links  whether `path` itself may be a symbolic link; its data file never is
base::Result<DecodedFile> DecodeFile(const std::filesystem::path& path, Links links, ImportPool& pool);

/// Sample number `i` of all, in the file's units (slope and intercept not applied).
double SampleAt(const ImageHeader& header, const std::byte* samples, std::size_t i);

/// Samples of one channel as labels (slope and intercept applied).
/// \return what keeps a sample from being a label, with its value; empty when all are whole numbers from 0 to
///         kLargestLabel that the file holds exactly
std::string CopyLabels(const ImageHeader& header, const std::byte* samples, std::uint32_t channel,
                       std::span<std::int32_t> labels);

/// Least and greatest grey value (slope and intercept applied), and a window that shows the most of it.
struct GreyStatistics {
  double least = 0, greatest = 255;
  DisplayWindow window;
};
GreyStatistics MeasureGrey(const ImageHeader& header, const std::byte* samples, std::size_t count);

/// One picture of `samples`, which begin with its first pixel. Where pixels are not square, the finer side is
/// kept and the other one interpolated.
/// \param width, height  of the picture to make
ColorImage RenderSlice(const ImageHeader& header, const std::byte* samples, const DisplayWindow& window,
                       int width, int height);

}  // namespace trocar::images
