// SPDX-License-Identifier: Apache-2.0
/// \file planner_fields.h  What each planner needs of a surgeon's view of a cholecystectomy, as values of its own.
///
/// The fields refer to the view, and hold as long as it does.
#pragma once

#include <cstdint>

#include "division_planner.h"
#include "hold_planner.h"
#include "hook_planner.h"
#include "spread_planner.h"
#include "surgeon_view.h"

namespace trocar::agent {

/// What ends a dissection with the hook before all is parted: DissectionGoal::until. The order is part of a saved state.
enum class DissectionEnd : std::uint8_t {
  kParted,         ///< nothing but the share
  kTriangleClear,  ///< as the critical view asks
  kLowerThirdFree,
  kBedStep  ///< a step of the bed is done, after which the hold is chosen anew
};
constexpr std::uint8_t Until(DissectionEnd end) noexcept {
  return static_cast<std::uint8_t>(end);
}

/// The gallbladder for the left hand; the liver must not come between its jaws.
HoldField SeeHold(const SurgeonView& view, const HoldFilter& may);
/// Fibres, and ducts and arteries that must stay, for the right hand's hook.
HookField SeeHook(const SurgeonView& view);
/// Fibres before the right hand's jaws, and every duct and artery beside them.
SeenSpread SeeSpread(const SurgeonView& view, const Spreading& work);
SpreadSight SeeSpreading(const SurgeonView& view);
/// Ducts, arteries and their clips, for the right hand.
SeenVessels SeeVessels(const SurgeonView& view);

}  // namespace trocar::agent
