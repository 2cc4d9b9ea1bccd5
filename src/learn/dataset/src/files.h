// SPDX-License-Identifier: Apache-2.0
/// \file files.h  Pictures, masks, boxes and arrays in the forms that loaders read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/render/geometry_picture.h"
#include "trocar/render/image.h"

namespace trocar::dataset {

/// An 8-bit grey PNG file.
/// \param pixels  (height * width)
/// \return kFileUnwritable
base::Status WriteGreyPng(const std::filesystem::path& path, int width, int height,
                          std::span<const std::uint8_t> pixels);
/// The same as an 8-bit PNG file of three equal channels.
base::Status WriteEqualChannelsPng(const std::filesystem::path& path, int width, int height,
                                   std::span<const std::uint8_t> pixels);
/// A second name for a file; a copy where the file system has no such names.
/// \return kFileUnwritable
base::Status LinkFile(const std::filesystem::path& file, const std::filesystem::path& name);
/// Quality 95, colours not thinned out. \return kFileUnwritable
base::Status WriteJpeg(const std::filesystem::path& path, const render::Image& image);
/// NumPy's format, version 1.0, of bytes. \return kFileUnwritable
base::Status WriteNpy(const std::filesystem::path& path, const std::vector<std::size_t>& shape,
                      std::span<const std::uint8_t> values);

/// Which pixels are meant.
using PixelTest = std::function<bool(std::uint16_t label)>;
/// (height * width) 1 where the test holds.
std::vector<std::uint8_t> MakeMask(const render::GeometryPicture& picture, const PixelTest& test);

/// Pixels x to x + width - 1, y to y + height - 1.
struct Box {
  int x = 0, y = 0, width = 0, height = 0;
};
/// Nothing where no pixel is meant.
std::optional<Box> FindBox(const render::GeometryPicture& picture, const PixelTest& test);

/// Run lengths column after column, beginning with a run of zeros: COCO's uncompressed form.
std::vector<std::uint32_t> CountRuns(std::span<const std::uint8_t> mask, int width, int height);

}  // namespace trocar::dataset
