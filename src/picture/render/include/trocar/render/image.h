// SPDX-License-Identifier: Apache-2.0
/// \file image.h  Pictures of red, green and blue bytes, and PNG files of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::render {

/// Rows from the top, three bytes a pixel, sRGB.
struct Image {
  int width = 0, height = 0;         ///< [pixels]
  std::vector<std::uint8_t> pixels;  ///< (3 * width * height)

  /// \pre 0 <= x < width, 0 <= y < height (TROCAR_ASSERT)
  std::array<std::uint8_t, 3> At(int x, int y) const;

  friend bool operator==(const Image&, const Image&) = default;
};

/// Mean of the absolute differences of all bytes [0 to 255].
/// \pre equal sizes (TROCAR_ASSERT)
double CalcMeanDifference(const Image& a, const Image& b);

/// The image as a PNG file's bytes; the same image gives the same bytes.
/// \return kFileUnwritable when the encoder refuses (no pixels, or too large)
base::Result<std::string> FormatPng(const Image& image);

/// Decodes a PNG of any kind to 8-bit RGB; transparency is laid over black.
/// \param source  name used in messages
/// \return kImageUndecodable; kFileTooLarge beyond 16384 pixels a side
base::Result<Image> ParsePng(std::string_view content, std::string_view source);

/// Writes a PNG file; a reader sees the old file or the new one, never a part.
/// \return kFileUnwritable
base::Status WritePng(const std::filesystem::path& path, const Image& image);

}  // namespace trocar::render
