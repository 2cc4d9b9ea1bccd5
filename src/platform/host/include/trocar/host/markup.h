// SPDX-License-Identifier: Apache-2.0
/// \file markup.h  Text inside HTML, SVG and XML.
#pragma once

#include <string>
#include <string_view>

namespace trocar::host {

/// Text that stands for itself between tags and in quoted attributes: & < > " ' replaced, and what PrintableText makes visible, which
/// XML does not allow and which could turn the text around it.
std::string EscapeMarkup(std::string_view text);

}  // namespace trocar::host
