// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/labels.h"

#include <array>

namespace trocar::view {
namespace {

using render::Material;

constexpr std::array<std::string_view, kLabelClassCount> kNames = {"nothing",
                                                                   "abdominal_wall",
                                                                   "liver",
                                                                   "gallbladder",
                                                                   "cystic_duct",
                                                                   "bile_duct",
                                                                   "cystic_artery",
                                                                   "artery",
                                                                   "bowel",
                                                                   "omentum",
                                                                   "triangle_fat",
                                                                   "ligament_fat",
                                                                   "connective_tissue",
                                                                   "blood",
                                                                   "bile",
                                                                   "rinse",
                                                                   "grasper",
                                                                   "dissector",
                                                                   "hook",
                                                                   "scissors",
                                                                   "clip_applier",
                                                                   "suction_irrigator",
                                                                   "bag",
                                                                   "trocar",
                                                                   "clip",
                                                                   "gallstone",
                                                                   "tissue_model",
                                                                   "object",
                                                                   "mark",
                                                                   "trainer_box",
                                                                   "linear_stapler"};

}  // namespace

std::string_view NameOf(LabelClass label) noexcept {
  return kNames[static_cast<std::size_t>(label)];
}

LabelClass FindLabelClass(const scene::SurfaceInfo& surface, bool has_patient) noexcept {
  if (!has_patient) return LabelClass::kTissueModel;
  if (!surface.triangles.empty()) {
    if (surface.organ == roles::OrganRole::kLiver) return LabelClass::kLiver;
    if (surface.organ == roles::OrganRole::kGallbladder) return LabelClass::kGallbladder;
    return LabelClass::kBowel;  // as it is drawn
  }
  switch (surface.tube) {
    case roles::TubeRole::kCysticDuct:
      return LabelClass::kCysticDuct;
    case roles::TubeRole::kCysticArtery:
      return LabelClass::kCysticArtery;
    case roles::TubeRole::kRightHepaticArtery:
      return LabelClass::kArtery;
    case roles::TubeRole::kOther:
      return surface.look == render::MaterialName(Material::kArtery) ? LabelClass::kArtery
                                                                     : LabelClass::kBileDuct;
    default:
      return LabelClass::kBileDuct;
  }
}

LabelClass FindLabelClass(instrument::ToolKind tool) noexcept {
  using Kind = instrument::ToolKind;
  switch (tool) {
    case Kind::kGrasper:
      return LabelClass::kGrasper;
    case Kind::kDissector:
      return LabelClass::kDissector;
    case Kind::kHook:
      return LabelClass::kHook;
    case Kind::kScissors:
      return LabelClass::kScissors;
    case Kind::kClipApplier:
      return LabelClass::kClipApplier;
    case Kind::kSuctionIrrigator:
      return LabelClass::kSuctionIrrigator;
    case Kind::kBag:
      return LabelClass::kBag;
    case Kind::kLinearStapler:
      return LabelClass::kLinearStapler;
  }
  return LabelClass::kNothing;
}

std::optional<instrument::ToolKind> ToolOf(LabelClass label) noexcept {
  for (const instrument::Tool& tool : instrument::AllTools()) {
    if (FindLabelClass(tool.kind) == label) return tool.kind;
  }
  return std::nullopt;
}

LabelClass FindLabelClass(Material material) noexcept {
  switch (material) {
    case Material::kPeritoneum:
      return LabelClass::kAbdominalWall;
    case Material::kBowel:
      return LabelClass::kBowel;
    case Material::kFat:
      return LabelClass::kOmentum;
    case Material::kFibre:
    case Material::kFilm:
      return LabelClass::kConnectiveTissue;
    case Material::kBlood:
      return LabelClass::kBlood;
    case Material::kBile:
      return LabelClass::kBile;
    case Material::kRinse:
      return LabelClass::kRinse;
    default:
      return LabelClass::kNothing;  // sparks, trails
  }
}

render::MaterialLabels MakeMaterialLabels() noexcept {
  render::MaterialLabels labels{};
  for (std::size_t i = 0; i < labels.size(); ++i)
    labels[i] = MakeLabel(FindLabelClass(static_cast<Material>(i)));
  return labels;
}

}  // namespace trocar::view
