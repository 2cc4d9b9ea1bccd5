// SPDX-License-Identifier: Apache-2.0
/// \file material.h  Appearance of a surface under the laparoscope. Looks only: no mechanical property.
#pragma once

#include <optional>
#include <string_view>

namespace trocar::render {

enum class Material {
  kLiver,        ///< deep red-brown capsule, fine lobules, sharp wet highlights
  kGallbladder,  ///< blue-green to yellow-grey translucent wall with fine vessels
  kDuct,         ///< yellowish green
  kArtery,       ///< red
  kFat,          ///< yellow lobules of the omentum
  kBowel,        ///< pink serosa
  kPeritoneum,   ///< abdominal wall and diaphragm from inside
  kShaft,        ///< black insulated shaft
  kSteel,        ///< polished steel
  kSleeve,       ///< grey plastic of a trocar
  kForce,        ///< signal colour of the force arrows
  kFibre,        ///< white strands of areolar tissue
  kFilm,         ///< peritoneum: thin, wet, light passes through
  kBlood,        ///< as a liquid
  kBile,         ///< as a liquid
  kRinse,        ///< clear irrigation fluid
  kLumen,        ///< the dark inside of a cut duct, vessel or tube
  kTitanium,     ///< clips
  kPouch,        ///< thin plastic of the retrieval bag; light passes through
  kStone,        ///< gallstone: yellow-brown cholesterol, dull
  kSpark,        ///< current through the air
  kRedRubber,    ///< things of training tasks
  kYellowRubber,
  kGreenRubber,
  kBlueRubber,
  kWhitePlastic,
  kBoard,    ///< what things of training tasks stand on: a pale mat with printed lines
  kBoxWall,  ///< of a box trainer
  kMark,     ///< bright: what is to be done next
  kSteam,    ///< of water that heat drives out of tissue
  kCount
};

/// "liver", "gallbladder", "duct", "artery", "fat", "bowel", "peritoneum", "shaft", "steel", "sleeve",
/// "force", "fibre", "film", "blood", "bile", "rinse", "lumen", "titanium", "pouch", "stone", "spark", "red_rubber",
/// "yellow_rubber", "green_rubber", "blue_rubber", "white_plastic", "board", "box_wall", "mark", "steam".
std::string_view MaterialName(Material material) noexcept;
/// The material of that name, or nothing.
std::optional<Material> FindMaterial(std::string_view name) noexcept;

}  // namespace trocar::render
