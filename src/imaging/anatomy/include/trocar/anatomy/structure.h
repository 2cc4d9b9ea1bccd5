// SPDX-License-Identifier: Apache-2.0
/// \file structure.h  Structures that a label of a segmentation can be, and the names that people and programs give them.
#pragma once

#include <cstdint>
#include <string_view>

#include "trocar/roles/roles.h"

namespace trocar::anatomy {

/// Structures that a label map may hold, as finely as it matters round the gallbladder.
enum class Structure : std::uint8_t {
  kUnknown,  ///< has no name, or one that the table has not
  kOther,    ///< known, and of no account here
  kLiver,
  kLiverPart,    ///< a lobe or segment: several make the liver
  kLiverLesion,  ///< tumour or cyst of the liver, which is drawn as liver
  kLiverVessel,
  kGallbladder,
  kGallbladderPart,  ///< its wall, its lumen or stones in it
  kBileDuct,
  kArtery,  ///< hepatic and cystic
  kSpleen,
  kStomach,
  kDuodenum,
  kColon,
  kSmallBowel,
  kPancreas,
  kKidneyRight,
  kKidneyLeft,
  kKidneys,  ///< both, or one of which the side is not said
  kAdrenalRight,
  kAdrenalLeft,
  kAdrenals,
  kVenaCava,
  kAorta,
  kPortalVein,
  kEsophagus,
  kLungRight,
  kLungLeft,
  kLungs,
  kHeart,
  kChest,  ///< what else lies above the diaphragm
  kHead,   ///< head and neck
  kBladder,
  kPelvis,  ///< what else lies in the pelvis or below
  kRibsRight,
  kRibsLeft,
  kRibs,
  kUpperVertebra,  ///< cervical, and thoracic down to T6
  kVertebra,       ///< further down
  kVertebraL3,
  kVertebraL4,
  kSacrum,
  kBody,  ///< the whole body's surface
  kCount
};

/// "liver", "kidney_right"
const char* NameOf(Structure structure) noexcept;

/// Finds the structure that a segment's name means. Case, accents, separators, the order of words, and words such as "mask" or
/// "whole" do not matter. The table holds Latin (Terminologia Anatomica), English, German, French, Spanish, Italian, Portuguese,
/// Dutch, Russian, Chinese, Japanese and Korean names, and those in public data sets. Nothing is guessed: "liver 2" is unknown.
/// \param name  UTF-8, or Latin-1
Structure FindStructure(std::string_view name);

/// Finds the structure that a code means, of SNOMED CT or SRT, its predecessor in DICOM: "10200004" and "T-62000" are the liver.
/// A side may follow it ("64033007 24028007": the right kidney), or "@" and the organ that something has changed ("108369006
/// @10200004": a neoplasm of the liver).
/// \return kUnknown for codes that the table has not
Structure FindCodedStructure(std::string_view code);

/// Whether a code says only that it is some part of a body, as 3D Slicer's "Tissue" does of a segment that nobody named.
bool IsGenericCode(std::string_view code);

/// Whether a program made that name up for a label that nobody named: "Segment_1", "Label 3", "7".
bool IsPlaceholder(std::string_view name);

/// The neighbour that a structure is, or kOther.
roles::NeighbourRole RoleOf(Structure structure) noexcept;

}  // namespace trocar::anatomy
