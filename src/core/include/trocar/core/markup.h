// SPDX-License-Identifier: Apache-2.0
/// \file markup.h  Text inside HTML, SVG and XML.
#pragma once

#include <string>
#include <string_view>

namespace trocar::core {

/// Text that stands for itself between tags and in quoted attributes: & < > " ' replaced.
std::string EscapeMarkup(std::string_view text);

}  // namespace trocar::core
