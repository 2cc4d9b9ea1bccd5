// SPDX-License-Identifier: Apache-2.0
/// \file hostile_places.h  Every kind of place at which a document can carry a text.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace trocar::printed_texts {

using Json = nlohmann::ordered_json;

/// The document once for each kind of place (elements of a list are of one kind), with `text` there: instead of a text, behind a text
/// that is there, and as the name of a field more; and once in all places.
void ForEachPlace(const Json& document, const std::string& text,
                  const std::function<void(const Json&, const std::string& place)>& visit);

}  // namespace trocar::printed_texts
