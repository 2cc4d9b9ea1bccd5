// SPDX-License-Identifier: Apache-2.0
/// \file injury.h  Consequences of the acts for the patient, derived from the network of ducts and arteries.
///
/// Source: Strasberg's classes of bile duct injury (Strasberg, Hertl and Soper, J Am Coll Surg 1995); consequences
/// from what still hangs together.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "trocar/roles/roles.h"
#include "trocar/scene/patient_vessels.h"
#include "trocar/surgery/flow_network.h"

namespace trocar::cholecystectomy {

/// Role of a duct or artery to the surgeon.
using VesselRole = roles::TubeRole;
/// Cystic duct, cystic artery and small ducts of the bed; every other duct and artery must stay.
inline constexpr std::array kDividedVessels = {VesselRole::kCysticDuct, VesselRole::kCysticArtery,
                                               VesselRole::kSubvesicalDuct};
bool MayBeDivided(VesselRole role) noexcept;

enum class Strasberg : std::uint8_t {
  kNone,
  kA,   ///< leak from the cystic duct's stump or from small ducts of the bed
  kB,   ///< a part of the biliary tree is shut off: an aberrant right duct
  kC,   ///< an aberrant right duct is cut and not closed
  kD,   ///< a hole in the side of a main duct
  kE1,  ///< main duct cut or shut more than 20 mm below the confluence
  kE2,  ///< less than that
  kE3,  ///< at the confluence, which is kept
  kE4,  ///< at the confluence, which is lost
  kE5   ///< main and aberrant right duct
};
/// "A" to "E5", "none"
std::string_view StrasbergName(Strasberg injury) noexcept;

struct InjuryReport {
  Strasberg strasberg = Strasberg::kNone;     ///< the worst
  bool drains_no_bile = false;                ///< no way from the liver to the bowel: jaundice
  bool is_right_liver_without_blood = false;  ///< ischaemia
  double bile_rate = 0;                       ///< that still leaks [m^3/s]
  double blood_rate = 0;                      ///< [m^3/s]
  int structures_entering = 0;                ///< ducts and arteries still joined to the gallbladder
  int spilled_stones = 0;                     ///< in the abdomen, not retrieved; the caller counts them
  /// Vessels that were clipped or cut though they must not be.
  std::vector<std::uint32_t> wrong_vessels;

  /// A main duct or the right hepatic artery has been clipped, cut or opened.
  bool IsCritical() const { return strasberg >= Strasberg::kD || is_right_liver_without_blood; }
};

/// \param network  with the pressures that hold at the end; solved anew
/// \pre roles, below_source and is_upstream_from are as many as vessels (TROCAR_ASSERT)
InjuryReport JudgeInjuries(const scene::VesselAnatomy& anatomy, const surgery::VesselActs& acts,
                           surgery::FlowNetwork& network);

}  // namespace trocar::cholecystectomy
