// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/scene_object.h"

#include <cstddef>
#include <iterator>

namespace trocar::scene {
namespace {

constexpr std::string_view kColours[] = {"red", "yellow", "green", "blue", "white", "grey", "black", "steel"};
static_assert(std::size(kColours) == static_cast<std::size_t>(ObjectColour::kCount));

}  // namespace

std::string_view ColourName(ObjectColour colour) noexcept {
  return kColours[static_cast<std::size_t>(colour)];
}

std::optional<ObjectColour> FindColour(std::string_view name) noexcept {
  for (std::size_t i = 0; i < std::size(kColours); ++i) {
    if (kColours[i] == name) return static_cast<ObjectColour>(i);
  }
  return std::nullopt;
}

}  // namespace trocar::scene
