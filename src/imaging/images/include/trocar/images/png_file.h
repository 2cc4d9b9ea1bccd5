// SPDX-License-Identifier: Apache-2.0
/// \file png_file.h  Pictures written as PNG files.
#pragma once

#include <filesystem>

#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"

namespace trocar::images {

/// PNG file of 8-bit red, green, blue; written beside and renamed.
/// \return kFileUnwritable
base::Status WritePng(const std::filesystem::path& path, const ColorImage& image);

}  // namespace trocar::images
