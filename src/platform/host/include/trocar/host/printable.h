// SPDX-License-Identifier: Apache-2.0
/// \file printable.h  Names that strangers chose, made fit for a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace trocar::host {

/// `text` for a terminal, a log or a label: control characters, marks that change the writing direction and
/// bytes that are no UTF-8 become \\xNN or \\u{NNNN}; a long text loses its middle.
///
/// \param most_characters  of the result, about; >= 16
std::string Printable(std::string_view text, std::size_t most_characters = 160);

}  // namespace trocar::host
