// SPDX-License-Identifier: Apache-2.0
/// \file tip_clouds.h  Fluids at a tip: water of a suction-irrigator, what it sucks in, and steam of tissue that current heats.
#pragma once

#include "trocar/instrument/tool.h"
#include "trocar/render/frame.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::view {

/// A jet of water from the bore to the tissue that it meets, where it splashes.
/// \param rate  [m^3/s]
void AddRinse(render::Frame& frame, const simulation::Snapshot& snapshot, const instrument::Tool& tool,
              const math::Pose& X_world_tool, double rate);

/// Liquid that runs from the pool into the bore; nothing where the tip does not reach it.
/// \param pool_reach  beyond the pool [m]
void AddSuction(render::Frame& frame, const simulation::Snapshot& snapshot, const instrument::Tool& tool,
                const math::Pose& X_world_tool, double pool_reach);

/// Water that boils out of the tissue at a place while current flows; char gives none.
void AddSteam(render::Frame& frame, const simulation::Snapshot& snapshot, const math::Vec3& p_world_source);

}  // namespace trocar::view
