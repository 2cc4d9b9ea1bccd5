// SPDX-License-Identifier: Apache-2.0
/// \file blade.h  The cutting edges of scissors and hook, and what they pass over from tick to tick.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "trocar/base/state_archive.h"
#include "trocar/geometry/blade_sweep.h"
#include "trocar/instrument/tool.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

enum class BladeKind : std::uint8_t {
  kScissors,  ///< cut while they close, from the hinge to the tip
  kHook       ///< cuts with its toe while it has power
};

struct BladeSettings {
  BladeKind kind = BladeKind::kScissors;
  geometry::BladeEdge p_tool_hook = instrument::kHookToe;  ///< toe of the hook, tool frame [m]
};

/// A blade from tick to tick.
struct BladeState {
  std::optional<geometry::BladeEdge> edge;  ///< where it was in the tick before, while it cuts [m]
  double jaw = 0;                           ///< opening in the tick before [rad]
};

void VisitState(base::StateArchive& archive, BladeState& blade);

/// One tick of a blade that cuts.
struct BladeMove {
  geometry::BladeEdge before, now;  ///< world frame [m]
};

/// Moves a blade. Scissors cut while their jaws close: what lies between the blades is cut from the hinge to the
/// tip, as far as they are closed; the edge is the piece between the two blades at that place. A hook's edge is
/// its toe.
///
/// \param jaw       whole opening [rad]
/// \param has_power  of the hook; ignored for scissors
/// \return the move, or nothing while it does not cut
/// \note Real-time safe.
std::optional<BladeMove> MoveBlade(const instrument::Tool& tool, const math::Pose& X_world_tool, double jaw,
                                   bool has_power, const BladeSettings& settings, BladeState& state) noexcept;

/// Finds the intact strands that a move crosses.
///
/// \param strands  of the definition from which the state's model was made
/// \param[out] cut  indices, ascending; the first ones that fit
/// \return how many
/// \note Real-time safe; the state is left as it is.
std::size_t FindCutStrands(const BladeMove& move, std::span<const tissue::Strand> strands,
                           const tissue::TissueState& state, std::span<std::uint32_t> cut) noexcept;

}  // namespace trocar::surgery
