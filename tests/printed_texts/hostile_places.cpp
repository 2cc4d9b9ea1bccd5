// SPDX-License-Identifier: Apache-2.0
#include "hostile_places.h"

#include <map>
#include <set>
#include <utility>

namespace trocar::printed_texts {
namespace {

/// The first place of each kind: a kind's name and where it is.
void ListPlaces(const Json& node, const std::string& kind, const Json::json_pointer& at,
                std::map<std::string, Json::json_pointer>& texts,
                std::map<std::string, Json::json_pointer>& objects) {
  if (node.is_string()) {
    texts.emplace(kind, at);
  } else if (node.is_object()) {
    objects.emplace(kind, at);
    for (const auto& [key, value] : node.items())
      ListPlaces(value, kind + "." + key, at / key, texts, objects);
  } else if (node.is_array()) {
    for (std::size_t i = 0; i < node.size(); ++i) ListPlaces(node[i], kind + "[]", at / i, texts, objects);
  }
}

}  // namespace

void ForEachPlace(const Json& document, const std::string& text,
                  const std::function<void(const Json&, const std::string& place)>& visit) {
  std::map<std::string, Json::json_pointer> texts, objects;
  ListPlaces(document, "", Json::json_pointer(), texts, objects);
  Json everywhere = document;
  for (const auto& [kind, at] : texts) {
    Json changed = document;
    changed[at] = text;
    visit(changed, kind);
    changed[at] = document[at].get<std::string>() + text;
    visit(changed, kind + " (behind)");
    if (kind != ".format") everywhere[at] = text;
  }
  for (const auto& [kind, at] : objects) {
    Json changed = document;
    changed[at][text] = text;
    visit(changed, kind + " (a field more)");
  }
  visit(everywhere, "everywhere");
}

}  // namespace trocar::printed_texts
