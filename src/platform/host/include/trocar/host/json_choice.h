// SPDX-License-Identifier: Apache-2.0
/// \file json_choice.h  A field of a JSON file that is one word of some: any other word is an error, never a default.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "trocar/host/json.h"

namespace trocar::host {

template <typename T>
using JsonChoices = std::initializer_list<std::pair<std::string_view, T>>;

/// \param choices  at least one: each word and what it means
/// \param code     of the complaint about another word, which names those that are known
/// \return the meaning of the field's word; after a complaint that of the first
template <typename T>
T OneOf(const JsonView& view, std::string_view key, JsonChoices<T> choices,
        base::ErrorCode code = base::ErrorCode::kJsonField) {
  const std::string text = view.Text(key);
  std::string known;
  for (const auto& [word, meaning] : choices) {
    if (text == word) return meaning;
    known += (known.empty() ? "\"" : ", \"") + std::string(word) + "\"";
  }
  view.Complain(std::string(key) + " is one of " + known, code);
  return choices.begin()->second;
}

/// OneOf() of a field that may be missing: then `fallback`.
template <typename T>
T OneOfOr(const JsonView& view, std::string_view key, T fallback, JsonChoices<T> choices,
          base::ErrorCode code = base::ErrorCode::kJsonField) {
  return view.Has(key) ? OneOf(view, key, choices, code) : fallback;
}

}  // namespace trocar::host
