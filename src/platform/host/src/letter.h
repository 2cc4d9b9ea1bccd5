// SPDX-License-Identifier: Apache-2.0
/// \file letter.h  Letters of UTF-8 text, and which of them may not reach a terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace trocar::host {

struct Letter {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: no UTF-8
};

/// The first letter of `text`, refusing overlong forms, surrogates and what lies beyond U+10FFFF.
/// \pre text is not empty
Letter DecodeLetter(std::string_view text);

/// Controls, line ends, and marks that change the writing direction.
bool IsHarmful(std::uint32_t code);

}  // namespace trocar::host
