// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/material.h"

#include <cstddef>
#include <iterator>

#include "trocar/roles/roles.h"

namespace trocar::render {
namespace {

using roles::TissueRole;

constexpr std::string_view kNames[] = {NameOf(TissueRole::kLiver),
                                       NameOf(TissueRole::kGallbladder),
                                       NameOf(TissueRole::kDuct),
                                       NameOf(TissueRole::kArtery),
                                       "fat",
                                       "bowel",
                                       "peritoneum",
                                       "shaft",
                                       "steel",
                                       "sleeve",
                                       "force",
                                       "fibre",
                                       "film",
                                       "blood",
                                       "bile",
                                       "rinse",
                                       "lumen",
                                       "titanium",
                                       "pouch",
                                       "stone",
                                       "spark",
                                       "red_rubber",
                                       "yellow_rubber",
                                       "green_rubber",
                                       "blue_rubber",
                                       "white_plastic",
                                       "board",
                                       "box_wall",
                                       "mark",
                                       "steam"};
static_assert(std::size(kNames) == static_cast<std::size_t>(Material::kCount));

}  // namespace

std::string_view MaterialName(Material material) noexcept {
  return kNames[static_cast<std::size_t>(material)];
}

std::optional<Material> FindMaterial(std::string_view name) noexcept {
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    if (kNames[i] == name) return static_cast<Material>(i);
  }
  return std::nullopt;
}

}  // namespace trocar::render
