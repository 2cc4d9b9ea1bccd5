// SPDX-License-Identifier: Apache-2.0
/// \file picture_size.h  --size of the commands that draw.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "trocar/base/result.h"

namespace trocar::cli {

/// \param text  like "1280x720" \return width and height [pixels], or kUsage
inline base::Result<std::array<int, 2>> ReadSize(const std::string& text) {
  std::array<int, 2> size{};
  char end = 0;
  if (std::sscanf(text.c_str(), "%5dx%5d%c", &size[0], &size[1], &end) != 2)
    return base::Error{base::ErrorCode::kUsage, "--size: \"" + text + "\" is not like 1280x720"};
  return size;
}

}  // namespace trocar::cli
