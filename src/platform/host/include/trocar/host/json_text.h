// SPDX-License-Identifier: Apache-2.0
/// \file json_text.h  Values of the JSON library as text.
///
/// Nothing else in this program writes JSON of texts (tests/texts/find_raw_output.py): the library throws at bytes that are no UTF-8
/// unless it is told what to do with them.
#pragma once

#include <string>
#include <string_view>

namespace trocar::host {

/// A text as JSON has it, in quotation marks; what is no UTF-8 becomes U+FFFD.
std::string QuoteJson(std::string_view text);

/// A value as JSON, whatever bytes its texts hold: what is no UTF-8 becomes U+FFFD.
///
/// \tparam Json  nlohmann::json or nlohmann::ordered_json, whose header the caller includes
/// \param indent  of each level [spaces]; < 0: one line
template <class Json>
std::string FormatJson(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace trocar::host
