// SPDX-License-Identifier: Apache-2.0
/// \file labels.h  Labels of everything in the laparoscope's picture: classes for segmentation, with instances.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "trocar/instrument/tool.h"
#include "trocar/render/geometry_picture.h"
#include "trocar/scene/tissue_layout.h"

namespace trocar::view {

enum class LabelClass : std::uint8_t {
  kNothing,
  kAbdominalWall,
  kLiver,
  kGallbladder,
  kCysticDuct,
  kBileDuct,  ///< common hepatic, common bile, right and left hepatic, aberrant and subvesical ducts
  kCysticArtery,
  kArtery,  ///< other ones
  kBowel,   ///< colon, stomach, duodenum; decoration
  kOmentum,
  kTriangleFat,       ///< that fills the hepatocystic triangle, as much of it as is there
  kLigamentFat,       ///< round the ends of ducts and vessels; decoration
  kConnectiveTissue,  ///< strands and their films
  kBlood,             ///< that runs, drips or lies as a pool; not the film on an organ
  kBile,
  kRinse,
  kGrasper,
  kDissector,
  kHook,
  kScissors,
  kClipApplier,
  kSuctionIrrigator,
  kBag,
  kTrocar,
  kClip,
  kGallstone,
  kTissueModel,  ///< of a training task
  kObject,       ///< of a training task
  kMark,         ///< what a training task points out
  kTrainerBox,
  kLinearStapler,
  kCount
};
inline constexpr std::size_t kLabelClassCount = static_cast<std::size_t>(LabelClass::kCount);
/// "nothing", "abdominal_wall", "liver", ...
std::string_view NameOf(LabelClass label) noexcept;

/// In a picture's labels the class is the low byte and the instance the high one: the surface of Simulation::Surfaces(),
/// the hand (2 for the assistant), the object; 0 where there is only one.
constexpr std::uint16_t MakeLabel(LabelClass label, std::size_t instance = 0) noexcept {
  return static_cast<std::uint16_t>(static_cast<std::size_t>(label) | (instance & 0xffU) << 8);
}
constexpr LabelClass ClassOf(std::uint16_t label) noexcept {
  return static_cast<LabelClass>(label & 0xffU);
}
constexpr std::uint8_t InstanceOf(std::uint16_t label) noexcept {
  return static_cast<std::uint8_t>(label >> 8);
}

/// Of an organ, a duct or a vessel.
/// \param has_patient  else it is a task's tissue model
LabelClass FindLabelClass(const scene::SurfaceInfo& surface, bool has_patient) noexcept;
LabelClass FindLabelClass(instrument::ToolKind tool) noexcept;
/// The tool of a class; nothing of others.
std::optional<instrument::ToolKind> ToolOf(LabelClass label) noexcept;
/// Of what is drawn by its material alone, and of scenery.
LabelClass FindLabelClass(render::Material material) noexcept;
/// Of all materials.
render::MaterialLabels MakeMaterialLabels() noexcept;

}  // namespace trocar::view
