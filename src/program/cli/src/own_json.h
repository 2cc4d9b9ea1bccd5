// SPDX-License-Identifier: Apache-2.0
/// \file own_json.h  JSON that another module has just written, to be part of a larger one.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "trocar/host/json.h"

namespace trocar::cli {

/// \pre `text` is of this program, not of a file (TROCAR_ASSERT that it is JSON)
inline nlohmann::ordered_json ParseOwnJson(std::string_view text) {
  return host::ParseJson<nlohmann::ordered_json>(text, "own JSON", host::kLargeJson).value();
}

}  // namespace trocar::cli
