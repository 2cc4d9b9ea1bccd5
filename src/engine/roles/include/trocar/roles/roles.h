// SPDX-License-Identifier: Apache-2.0
/// \file roles.h  Roles of organs, ducts, vessels, regions, landmarks and materials in surgery, and their names in files.
///
/// A role is resolved once, where a patient is read or made; programs ask for the role afterwards, never for a name. The
/// names stand here and nowhere else (tests/anatomy_names looks for others).
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace trocar::roles {

/// kOther: an organ that is simulated and drawn, and of which nothing more is known.
enum class OrganRole : std::uint8_t { kOther, kLiver, kGallbladder };

/// kOther: a duct or artery that must stay, as the common hepatic duct or the right hepatic artery must.
enum class TubeRole : std::uint8_t {
  kOther,
  kCysticDuct,
  kCommonHepaticDuct,
  kCommonBileDuct,
  kRightHepaticDuct,
  kLeftHepaticDuct,
  kAberrantRightDuct,  ///< drains a part of the right lobe below the confluence
  kSubvesicalDuct,     ///< Luschka's: small, in the bed
  kCysticArtery,
  kRightHepaticArtery
};

/// Vertices of an organ. The first three and kHeld are the fixed boundary of section 3.2.2 of the paper.
enum class RegionRole : std::uint8_t {
  kOther,
  kDiaphragmaticFace,
  kFalciform,
  kCoronary,
  kHeld,  ///< the border of a training task's sheet
  kGallbladderBed
};

enum class LandmarkRole : std::uint8_t {
  kOther,
  kUmbilicus,
  kUmbilicalFissure,
  kFundus,
  kInfundibulum,
  kGallbladderBody,
  kLiverEdge,
  kHepatocysticTriangle
};

/// Role of a structure beside the operated organs, which is seen and touched, but not simulated.
enum class NeighbourRole : std::uint8_t {
  kOther,
  kStomach,
  kDuodenum,
  kColon,
  kSmallBowel,
  kPancreas,
  kRightKidney,
  kVenaCava,
  kAorta,
  kPortalVein,
  kRibs,
  kSpine
};
inline constexpr std::size_t kNeighbourRoleCount = 12;

/// Role of a strand that dissection divides.
enum class StrandRole : std::uint8_t {
  kBed,  ///< gallbladder to liver
  kAdhesion,
  kTriangle,    ///< fat and fibres of the hepatocystic triangle
  kPeritoneum,  ///< its cover, front and back
  kEnd,         ///< of a tube in its organ
  kBand         ///< of a training task: part of a band
};

/// Tissue that a material describes.
enum class TissueRole : std::uint8_t { kOther, kLiver, kGallbladder, kGallbladderBed, kDuct, kArtery };

/// Names as files write them, in the order of the roles.
template <class Role>
struct RoleNames;
template <>
struct RoleNames<OrganRole> {
  static constexpr const char* kNames[] = {"other", "liver", "gallbladder"};
};
template <>
struct RoleNames<TubeRole> {
  static constexpr const char* kNames[] = {"other",
                                           "cystic_duct",
                                           "common_hepatic_duct",
                                           "common_bile_duct",
                                           "right_hepatic_duct",
                                           "left_hepatic_duct",
                                           "aberrant_right_duct",
                                           "subvesical_duct",
                                           "cystic_artery",
                                           "right_hepatic_artery"};
};
template <>
struct RoleNames<RegionRole> {
  static constexpr const char* kNames[] = {"other", "diaphragmatic_face", "falciform", "coronary",
                                           "held",  "gallbladder_bed"};
};
template <>
struct RoleNames<LandmarkRole> {
  static constexpr const char* kNames[] = {
      "other",        "umbilicus",        "umbilical_fissure", "fundus",
      "infundibulum", "gallbladder_body", "liver_edge",        "hepatocystic_triangle"};
};
template <>
struct RoleNames<NeighbourRole> {
  static constexpr const char* kNames[] = {
      "other",    "stomach",      "duodenum",           "colon", "small_bowel",
      "pancreas", "kidney_right", "inferior_vena_cava", "aorta", "portal_vein_and_splenic_vein",
      "ribs",     "spine"};
  static_assert(std::size(kNames) == kNeighbourRoleCount);
};
template <>
struct RoleNames<StrandRole> {
  static constexpr const char* kNames[] = {"bed_strand",        "adhesion_strand", "triangle_strand",
                                           "peritoneum_strand", "end_strand",      "band_strand"};
};
template <>
struct RoleNames<TissueRole> {
  static constexpr const char* kNames[] = {"other",           "liver", "gallbladder",
                                           "gallbladder_bed", "duct",  "artery"};
};

/// A procedure may bring roles of its own along, for organs, tubes and landmarks that are none of the above: numbers from here on, with
/// names that it registers (scene::Procedure). Of tubes those from kFirstOwnArtery on are arteries.
inline constexpr std::uint8_t kFirstOwnRole = 64, kFirstOwnArtery = 128;
template <class Role>
constexpr bool IsOwn(Role role) noexcept {
  return static_cast<std::uint8_t>(role) >= kFirstOwnRole;
}

/// "gallbladder", "cystic_duct"; of a procedure's own role "other": procedures::NameOf knows it.
template <class Role>
constexpr const char* NameOf(Role role) noexcept {
  const auto i = static_cast<std::size_t>(role);
  return RoleNames<Role>::kNames[i < std::size(RoleNames<Role>::kNames) ? i : 0];
}

/// The role of that name; nothing where there is none.
template <class Role>
constexpr std::optional<Role> FindRole(std::string_view name) noexcept {
  for (std::size_t i = 0; i < std::size(RoleNames<Role>::kNames); ++i) {
    if (name == RoleNames<Role>::kNames[i]) return static_cast<Role>(i);
  }
  return std::nullopt;
}

/// The role of what bears a conventional name and whose file says nothing else.
template <class Role>
constexpr Role ConventionalRole(std::string_view name) noexcept {
  return FindRole<Role>(name).value_or(Role::kOther);
}
/// A patient may have several of one role: "cystic_artery_deep" is a cystic artery, too.
template <>
constexpr TubeRole ConventionalRole<TubeRole>(std::string_view name) noexcept {
  for (std::size_t i = 1; i < std::size(RoleNames<TubeRole>::kNames); ++i) {
    const std::string_view conventional = RoleNames<TubeRole>::kNames[i];
    if (name == conventional || (name.starts_with(conventional) && name[conventional.size()] == '_'))
      return static_cast<TubeRole>(i);
  }
  return TubeRole::kOther;
}

/// "cystic duct": as a person reads it.
std::string SpokenName(std::string_view name);
template <class Role>
requires std::is_enum_v<Role> std::string SpokenName(Role role) {
  return SpokenName(std::string_view(NameOf(role)));
}

/// "liver, gallbladder": every role but kOther, for messages.
template <class Role>
std::string ListNames() {
  std::string names;
  for (std::size_t i = 1; i < std::size(RoleNames<Role>::kNames); ++i)
    names += (i == 1 ? "" : ", ") + std::string(RoleNames<Role>::kNames[i]);
  return names;
}

/// A duct rather than an artery.
constexpr bool IsDuct(TubeRole role) noexcept {
  if (IsOwn(role)) return static_cast<std::uint8_t>(role) < kFirstOwnArtery;
  return role != TubeRole::kCysticArtery && role != TubeRole::kRightHepaticArtery;
}
/// An organ with a cavity, which leaks where its wall is opened. A procedure's own is what it takes out.
constexpr bool IsHollow(OrganRole role) noexcept {
  return role != OrganRole::kOther && role != OrganRole::kLiver;
}

/// A hollow organ that lies in the bed of another, from which it can be taken off, in every patient that has both.
struct OrganBed {
  OrganRole organ, host;
};
inline constexpr OrganBed kOrganBeds[] = {{OrganRole::kGallbladder, OrganRole::kLiver}};
inline constexpr RegionRole kBedRegion = RegionRole::kGallbladderBed;  ///< of the organ: what lies in the bed
inline constexpr TissueRole kBedTissue = TissueRole::kGallbladderBed;  ///< of the fibres between them

/// Whether a region's vertices never move.
constexpr bool IsFixed(RegionRole role) noexcept {
  return role == RegionRole::kDiaphragmaticFace || role == RegionRole::kFalciform ||
         role == RegionRole::kCoronary || role == RegionRole::kHeld;
}
/// Tissue of which an organ is made.
constexpr TissueRole TissueOf(OrganRole role) noexcept {
  return role == OrganRole::kLiver         ? TissueRole::kLiver
         : role == OrganRole::kGallbladder ? TissueRole::kGallbladder
                                           : TissueRole::kOther;
}

}  // namespace trocar::roles
